import { readFileSync } from "node:fs";
import type { Stretch } from "../../robowidgets/js/laser/sector.ts";
import type { Scan } from "../../robowidgets/js/shared/frames/scan.ts";
import type { Mount } from "../../robowidgets/js/shared/traits.ts";
import type { Limits } from "../../robowidgets/js/speed/traits.ts";
import { scanOf } from "./laser.ts";

/** The scan that Python would send: limits rounded to float32, and a missing increment as 0. */
export function toScan(given: ScanCase): Scan {
  const values = given.ranges ?? Array.from({ length: given.count ?? 0 }, () => given.fill ?? 0);
  const ranges = values.map(toNumber);
  for (const [index, value] of Object.entries(given.differ ?? {})) ranges[Number(index)] = toNumber(value);
  return scanOf(ranges, {
    angleMin: given.angle_min,
    angleIncrement: toNumber(given.angle_increment) || 0,
    minRange: Math.fround(given.range_min),
    maxRange: Math.fround(given.range_max),
  });
}

/** A number, or a word for a number that JSON lacks. */
export type Word = number | "nan" | "inf" | "-inf";

export interface ScanCase {
  name: string;
  angle_min: number;
  angle_increment: Word;
  range_min: number;
  range_max: number;
  ranges?: Word[];
  count?: number;
  fill?: Word;
  differ?: Record<string, Word>;
  validity?: number[];
  counts: number[];
  nearest: number | null;
  full_circle: boolean;
  angles?: Record<string, number>;
  at?: [number, number | null][];
}

interface Vectors {
  scans: ScanCase[];
  limits: [Word, Limits, string][];
  frames: Record<string, { base64: string; reads: unknown }>;
  sectors: Record<
    string,
    [held: [Stretch[], Word, number, Word, number][], own: [first: number, last: number, start: number, end: number][]]
  >;
  rays: [of: [number, number, number], on: [number, number, number], rays: number[]][];
  ranges: [range: Word, minRange: number, maxRange: Word, kind: number, distance: Word][];
  images: [
    encoding: string,
    frame: string,
    about: { channels?: string; recolored?: boolean },
    letters: string,
    values: number[],
    why: string,
    statistics: number[][] | null,
  ][];
  selections: [bands: Record<string, [number, number]>, codes: Record<string, string | null>][];
  spreads: [scans: Word[][], spread: Word[]][];
  silences: [step: Word, onShow: number, listed: Word][];
  steps: [times: number[], step: Word][];
  beats: { beat: number; page: number; "scan gap": number };
  codes: [
    start: number,
    end: number,
    offset: number,
    mount: Mount | null,
    scan: string,
    message: string,
    slice: string,
  ][];
}

/** The cases that Python's tests read too. */
export const vectors: Vectors = JSON.parse(readFileSync(new URL("../vectors.json", import.meta.url), "utf8"));

const WORDS: Record<string, number> = { nan: NaN, inf: Infinity, "-inf": -Infinity };

export function toNumber(word: Word): number {
  return WORDS[word] ?? Number(word);
}

/** A frame that Python packed, starting at an offset of a larger buffer, as binary traits do. */
export function frameOf(name: string, offset = 5): DataView {
  const packed = Buffer.from(vectors.frames[name]?.base64 ?? "", "base64");
  const bytes = new Uint8Array(offset + packed.length + 3);
  bytes.set(packed, offset);
  return new DataView(bytes.buffer, offset, packed.length);
}

/** The expected content of a frame. */
// biome-ignore lint/suspicious/noExplicitAny: a test compares it with what was read.
export function readsOf(name: string): any {
  return JSON.parse(JSON.stringify(vectors.frames[name]?.reads), (_, value) => WORDS[value] ?? value);
}
