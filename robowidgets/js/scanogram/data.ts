import { copyOf } from "../shared/bytes.ts";
import type { Validity } from "../shared/frames/scan.ts";
import * as validity from "../shared/frames/scan.ts";
import type { Pixel } from "./traits.ts";

/** Cells in a row: each is of `size` scans, and holds a code for each ray (or for each few neighbours). */
export interface Block {
  size: number;
  /** Number of the first scan. */
  first: number;
  rayStep: number;
  /** Rays of a cell. */
  rays: number;
  /** Seconds at which each cell starts and ends. */
  startsAt: Float64Array;
  endsAt: Float64Array;
  /** Cell after cell, ray after ray. */
  codes: Uint16Array;
  /** The ranges themselves, or empty if they are unknown. */
  ranges: Float32Array;
}

/** Spans of speed: start of each, and for each axis the least and the greatest in it. */
export interface Speeds {
  startsAt: Float64Array;
  least: Float32Array[];
  greatest: Float32Array[];
}

export interface Sweep {
  angleMin: number;
  angleIncrement: number;
  count: number;
  minRange: number;
  maxRange: number;
  /** True if scans had different rays and are drawn by angle; an index then is not the same ray in all of them. */
  byAngle: boolean;
  /** The distance of the greatest code. */
  far: number;
}

/** The whole recording in coarse detail; seconds and metres. */
export interface Whole {
  /** Counts the pictures that Python has sent. */
  edition: number;
  sweep: Sweep;
  scanCount: number;
  /** The number of scans of the drive if the picture has only some of them, evenly spread. */
  driveScans?: number;
  /** Start and end of the picture. */
  span: [number, number];
  /** Usual seconds from scan to scan. */
  pause: number;
  /** Number of rays of each class, numbered as in Python. */
  counts: number[];
  /** Metres of the nearest and the farthest color, fitted to the readings of all scans. */
  colors: [number, number];
  /** The reading that the cells show. */
  pixel: Pixel;
  block: Block;
  speed: { title: string; axes: string[]; limits: ([number, number] | null)[]; gap: number; speeds: Speeds } | null;
  touch: { title: string; sensors: string[]; spans: NamedSpan[] } | null;
}

/** A span in which a sensor was touched, or that is marked, with its name. */
export interface NamedSpan {
  start: number;
  end: number;
  name: string;
}

/** The finer detail that the page requested. */
export interface Detail {
  /** Edition of the whole that it belongs to. */
  edition: number;
  span: [number, number];
  block: Block;
  speeds: Speeds | null;
}

/** The order of codes: the least of several is shown. Python has the same numbers. */
export const TOO_CLOSE = 0;
export const CLOSEST = 1;
export const FARTHEST = 65_001;
export const OUTSIDE_LIMITS = 65_532;
export const NO_MEASUREMENT = 65_533;
export const NOTHING_IN_RANGE = 65_534;
export const NO_SCAN = 65_535;

/** The classes of the codes that stand for no reading, numbered as in Python. */
export const KINDS: Record<number, Validity> = {
  [TOO_CLOSE]: validity.TOO_CLOSE,
  [OUTSIDE_LIMITS]: validity.OUTSIDE_LIMITS,
  [NO_MEASUREMENT]: validity.NO_MEASUREMENT,
  [NOTHING_IN_RANGE]: validity.NOTHING_IN_RANGE,
};

export function kindOf(code: number): Validity {
  return KINDS[code] ?? validity.READING;
}

const ARRAYS = { f8: Float64Array, f4: Float32Array, u2: Uint16Array };
export type Numbers = Float64Array | Float32Array | Uint16Array;
/** Facts about the whole recording. Details have only some of them. */
export interface Facts {
  arrays: [string, keyof typeof ARRAYS, number][];
  edition: number;
  level: number;
  first: number;
  ray_step: number;
  span: [number, number];
  angle_min: number;
  angle_increment: number;
  ray_count: number;
  range_min: number;
  range_max: number;
  far: number;
  by_angle: boolean;
  scan_count: number;
  drive_scans: number | undefined;
  begin: number;
  duration: number;
  pause: number;
  class_counts: number[];
  colors: [number, number];
  pixel: Pixel;
  speed: Omit<NonNullable<Whole["speed"]>, "speeds"> | undefined;
  touch: Omit<NonNullable<Whole["touch"]>, "spans"> | undefined;
}
type Unpacked = { facts: Facts; arrays: Map<string, Numbers> };

export function decodeWhole(bytes: DataView): Whole {
  const { facts, arrays } = unpack(bytes);
  const sweep = toSweep(facts);
  const { speed, touch } = facts;
  const speeds = toSpeeds(arrays);
  return {
    edition: facts.edition,
    sweep,
    scanCount: facts.scan_count,
    ...(facts.drive_scans === undefined ? {} : { driveScans: facts.drive_scans }),
    span: [facts.begin, facts.duration],
    pause: facts.pause,
    counts: facts.class_counts,
    colors: facts.colors,
    pixel: facts.pixel,
    block: toBlock(facts, arrays, sweep),
    speed: speed && speeds ? { ...speed, speeds } : null,
    touch: touch ? { ...touch, spans: toTouches(arrays.get("touches"), touch.sensors) } : null,
  };
}

export function toSweep(facts: Facts): Sweep {
  return {
    angleMin: facts.angle_min,
    angleIncrement: facts.angle_increment,
    count: facts.ray_count,
    minRange: facts.range_min,
    maxRange: facts.range_max,
    far: facts.far,
    byAngle: facts.by_angle,
  };
}

export function decodeDetail(bytes: DataView, sweep: Sweep): Detail {
  const { facts, arrays } = unpack(bytes);
  return {
    edition: facts.edition,
    span: facts.span,
    block: toBlock(facts, arrays, sweep),
    speeds: toSpeeds(arrays),
  };
}

/** The code of a range. The least of several codes is shown, as in Python. */
export function toCode(range: number, { minRange, maxRange, far }: Sweep): number {
  if (minRange <= range && range <= maxRange) {
    return CLOSEST + Math.floor(((range - minRange) * (FARTHEST - CLOSEST)) / (far - minRange));
  }
  if (range === -Infinity) return TOO_CLOSE;
  if (range === Infinity) return NOTHING_IN_RANGE;
  return Number.isNaN(range) ? NO_MEASUREMENT : OUTSIDE_LIMITS;
}

/** Metres of the code of a reading. */
export function toRange(code: number, { minRange, far }: Sweep): number {
  return minRange + ((code - CLOSEST + 0.5) * (far - minRange)) / (FARTHEST - CLOSEST);
}

/** The facts and the arrays of a frame; docs/developers/frames.md has the layout. */
export function unpack(bytes: DataView): Unpacked {
  const length = bytes.getUint32(0, true);
  const text = new TextDecoder().decode(copyOf(bytes, 4, length));
  const facts = JSON.parse(text) as Facts;
  let next = 4 + length;
  const arrays = new Map<string, Numbers>();
  for (const [name, kind, count] of facts.arrays) {
    const Kind = ARRAYS[kind];
    arrays.set(name, new Kind(copyOf(bytes, next, count * Kind.BYTES_PER_ELEMENT)));
    next += count * Kind.BYTES_PER_ELEMENT;
  }
  return { facts, arrays };
}

function toBlock(facts: Facts, arrays: Unpacked["arrays"], sweep: Sweep): Block {
  const startsAt = arrays.get("starts") as Float64Array;
  const cells = arrays.get("cells");
  const ranges = cells instanceof Float32Array ? cells : new Float32Array();
  const codes = cells instanceof Uint16Array ? cells : Uint16Array.from(ranges, (range) => toCode(range, sweep));
  return {
    size: 2 ** facts.level,
    first: facts.first,
    rayStep: facts.ray_step,
    rays: startsAt.length ? codes.length / startsAt.length : 0,
    startsAt,
    endsAt: arrays.get("ends") as Float64Array,
    codes,
    ranges,
  };
}

function toSpeeds(arrays: Unpacked["arrays"]): Speeds | null {
  const startsAt = arrays.get("speed_starts") as Float64Array | undefined;
  const values = arrays.get("speeds") as Float32Array | undefined;
  if (!startsAt || !values) return null;
  const count = startsAt.length;
  const rows = count ? values.length / count : 0;
  const row = (i: number) => values.subarray(i * count, (i + 1) * count);
  const pick = (offset: number) => Array.from({ length: rows / 2 }, (_, axis) => row(2 * axis + offset));
  return { startsAt, least: pick(0), greatest: pick(1) };
}

function toTouches(spans: Numbers | undefined, sensors: string[]): NamedSpan[] {
  return Array.from({ length: (spans?.length ?? 0) / 3 }, (_, i) => {
    const [start = 0, end = 0, sensor = 0] = spans?.subarray(3 * i, 3 * i + 3) ?? [];
    return { start, end, name: sensors[sensor] ?? "" };
  });
}
