import { Reader } from "../bytes.ts";
import { type Frame, readHead } from "../stream.ts";

/** The classes of REP-117, numbered as in Python. */
export const READING = 0;
export const TOO_CLOSE = 1;
export const NOTHING_IN_RANGE = 2;
export const NO_MEASUREMENT = 3;
export const OUTSIDE_LIMITS = 4;
export type Validity = 0 | 1 | 2 | 3 | 4;

/** The rays' directions: ray i points at angleMin + i * angleIncrement, radians counter-clockwise from forward. */
export interface Sweep {
  angleMin: number;
  angleIncrement: number;
  count: number;
}

/** Metres within which a range is a reading. */
export interface Limits {
  minRange: number;
  maxRange: number;
}

/** Metres; no view reaches farther. Python has the same number. */
export const FARTHEST_VIEW = 100_000;

/** Metres; a larger range_max counts as no limit. */
export const NO_LIMIT = 2000;

/** One scan as it comes from Python; metres and radians. */
export interface Scan extends Frame, Sweep, Limits, Census {
  ranges: Float32Array;
  /** Class of each ray. */
  kinds: Validity[];
  /** As long as ranges, or empty. */
  intensities: Float32Array;
  /**
   * Of each ray its number in the data that the scan was made of, such as an echo of many, or NaN. As long as ranges,
   * or empty.
   */
  sources: Float32Array;
}

export function decodeScan(bytes: DataView): Scan {
  const reader = new Reader(bytes);
  const head = readHead(reader);
  const [angleMin = 0, angleIncrement = 0, minRange = 0, maxRange = 0, count = 0] = reader.float64s(5);
  const ranges = reader.float32s(count);
  const kinds = Array.from(ranges, (range) => classify(range, minRange, maxRange));
  const lit = reader.left ? reader.float32s(count) : new Float32Array();
  const sources = reader.float32s(reader.left / 4);
  const intensities = sources.length && lit.every(Number.isNaN) ? new Float32Array() : lit;
  return {
    ...head,
    angleMin,
    angleIncrement,
    minRange,
    maxRange,
    count,
    ranges,
    kinds,
    intensities,
    sources,
    ...takeCensus(ranges, kinds, minRange),
  };
}

const TURN = 2 * Math.PI;

export function angleOf(sweep: Sweep, index: number): number {
  return sweep.angleMin + index * sweep.angleIncrement;
}

/** The class of a range. Readings first: any comparison with NaN is false. */
export function classify(range: number, minRange: number, maxRange: number): Validity {
  if (minRange <= range && range <= maxRange) return READING;
  if (range === -Infinity) return TOO_CLOSE;
  if (range === Infinity) return NOTHING_IN_RANGE;
  if (Number.isNaN(range)) return NO_MEASUREMENT;
  return OUTSIDE_LIMITS;
}

type Counts = [number, number, number, number, number];

interface Census {
  /** Number of rays of each class. */
  counts: Counts;
  /** Index of the ray with the nearest obstacle, or -1. "Too close to measure" is nearer than any reading. */
  nearest: number;
}

export function takeCensus(ranges: Float32Array, kinds: Validity[], minRange: number): Census {
  // Metres; a smaller range that is also below range_min is an error code. Python has the same number.
  const codesEnd = 0.0195;
  const counts: Counts = [0, 0, 0, 0, 0];
  let nearest = -1;
  let least = Infinity;
  for (const [i, kind] of kinds.entries()) {
    counts[kind]++;
    let range = ranges[i] as number;
    if (kind !== READING) range = kind === TOO_CLOSE || (range >= codesEnd && range < minRange) ? 0 : Infinity;
    if (range < least) {
      least = range;
      nearest = i;
    }
  }
  return { counts, nearest };
}

/** Returns true if the rays close a full circle. */
export function isFullCircle({ angleIncrement, count }: Sweep): boolean {
  const step = Math.abs(angleIncrement);
  return count > 1 && step * count > TURN - step / 2;
}

/** The angles between which the rays lie, the smaller first; a full turn if they close a circle. */
export function spanOf(sweep: Sweep): [number, number] {
  const ends = [angleOf(sweep, 0), angleOf(sweep, Math.max(0, sweep.count - 1))];
  const from = Math.min(...ends);
  return [from, isFullCircle(sweep) ? from + TURN : Math.max(...ends)];
}

/** The same direction as an angle, at the first turn that is not below another. */
export function angleFrom(from: number, angle: number): number {
  return angle + Math.ceil((from - angle) / TURN) * TURN;
}

/** The index of the ray closest to an angle; -1 when the angle is not swept. */
export function indexAt(sweep: Sweep, angle: number): number {
  const { angleMin, angleIncrement, count } = sweep;
  if (count === 0) return -1;
  const step = Math.abs(angleIncrement) || TURN;
  const ahead = angleIncrement < 0 ? angleMin - angle : angle - angleMin;
  const turned = ((ahead % TURN) + TURN) % TURN;
  const index = Math.round(turned / step);
  const [toRay, toFirst] = [Math.abs(turned - index * step), TURN - turned];
  if (index < count && toRay <= toFirst) return index;
  return toFirst <= step / 2 ? 0 : -1;
}
