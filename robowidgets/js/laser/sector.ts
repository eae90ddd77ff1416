import { angleOf, READING, type Scan, type Sweep, takeCensus } from "../shared/frames/scan.ts";

/** Rays between two angles in radians, from the first counter-clockwise to the second, with limits in metres. */
export interface Sector {
  start: number;
  end: number;
  near?: number;
  warning?: number;
  stop?: number;
  hysteresis?: number;
}

/** Rays that follow each other in the array: from an index up to, and without, another. */
export type Stretch = [start: number, stop: number];

const TURN = 2 * Math.PI;
/** Radians. */
export const DEGREE = Math.PI / 180;

/** By the product that Python computes, so that both have the same bits. */
export const inDegrees = (radians: number): number => radians * (180 / Math.PI);

/** Radians. Python has the same number. */
const ROUNDING = 1e-6;

const modulo = (value: number, turn: number): number => ((value % turn) + turn) % turn;

/** Radians from the first angle to the second; a full turn for the whole circle. */
export function sweepOf({ start, end }: Sector): number {
  return end - start >= TURN ? TURN : modulo(end - start, TURN);
}

/** Returns true if an angle lies in a sector, its ends included. */
export function isIn(sector: Sector, angle: number): boolean {
  return modulo(angle - sector.start + ROUNDING, TURN) <= sweepOf(sector) + 2 * ROUNDING;
}

/** The stretches of the array that lie in a sector, in the order in which the scanner passes through it. */
export function stretchesOf(sweep: Sweep, sector: Sector): Stretch[] {
  const found: Stretch[] = [];
  const reach = sweepOf(sector) + 2 * ROUNDING;
  for (let i = 0; i < sweep.count; i++) {
    if (modulo(angleOf(sweep, i) - sector.start + ROUNDING, TURN) > reach) continue;
    const last = found.at(-1);
    if (last?.[1] === i) last[1] = i + 1;
    else found.push([i, i + 1]);
  }
  const passed = ([start]: Stretch) => {
    const angle = angleOf(sweep, start);
    const turned = sweep.angleIncrement < 0 ? sector.end - angle : angle - sector.start;
    return modulo(turned + ROUNDING, TURN);
  };
  return found.sort((a, b) => passed(a) - passed(b));
}

/** The stretches as a program writes them: "ranges[540:610]", "ranges[350:] + ranges[:10]"; "" for none. */
export function toExpression(stretches: Stretch[], count: number): string {
  const isOne = stretches.length === 1;
  return stretches
    .map(([start, stop]) => `ranges[${!isOne && start === 0 ? "" : start}:${!isOne && stop === count ? "" : stop}]`)
    .join(" + ");
}

/** Measurements of the rays of a sector. */
export interface Measured {
  /** As in Python's `Scan.distance`: 0 if too close, Infinity if nothing is in range, NaN if unknown. */
  distance: number;
  /** Index of the ray to the nearest thing; -1 if nothing is in range, or the distance is unknown. */
  nearest: number;
  /** Metres, of the readings; NaN without any. */
  median: number;
  /** Rays with a reading. */
  valid: number;
  count: number;
}

export function measure({ ranges, kinds, minRange, maxRange }: Scan, stretches: Stretch[]): Measured {
  let [distance, nearest, count] = [Infinity, -1, 0];
  let isKnown = false;
  const readings: number[] = [];
  for (const [start, stop] of stretches) {
    const part = ranges.subarray(start, stop);
    const partKinds = kinds.slice(start, stop);
    const census = takeCensus(part, partKinds, minRange);
    count += part.length;
    for (const [i, kind] of partKinds.entries()) if (kind === READING) readings.push(part[i] as number);
    isKnown ||= census.nearest >= 0 || part.some((range) => range > maxRange);
    if (census.nearest < 0) continue;
    const isReading = partKinds[census.nearest] === READING;
    const away = isReading ? (part[census.nearest] as number) : 0;
    if (away < distance || (away === distance && start + census.nearest < nearest)) {
      distance = away;
      nearest = start + census.nearest;
    }
  }
  readings.sort((a, b) => a - b);
  const middle = readings.length / 2;
  const median = ((readings[Math.ceil(middle) - 1] ?? NaN) + (readings[Math.floor(middle)] ?? NaN)) / 2;
  return { distance: isKnown ? distance : NaN, nearest, median, valid: readings.length, count };
}

/** The state that the limits of a sector set; "" for a sector without limits. */
export type State = "stop" | "warning" | "occupied" | "free" | "unknown" | "";

/** The limits with the states that they set, the most severe first. */
export const LIMITS = [
  ["stop", "stop"],
  ["warning", "warning"],
  ["near", "occupied"],
] as const;

/** @param before the state at the previous scan, which holds up to the hysteresis */
export function stateOf(sector: Sector, distance: number, before: State): State {
  if (LIMITS.every(([name]) => sector[name] === undefined)) return "";
  if (Number.isNaN(distance)) return "unknown";
  const was = LIMITS.findIndex(([, state]) => state === before);
  for (const [i, [name, state]] of LIMITS.entries()) {
    const limit = sector[name];
    if (limit !== undefined && distance < limit + (was >= 0 && was <= i ? (sector.hysteresis ?? 0) : 0)) return state;
  }
  return "free";
}

/** Degrees that rounding may lose; `isIn` allows for more. */
const LOST = 3e-5;

/**
 * The sector of the rays from one index to another, both included; on a full circle they may lie beyond the array. Its
 * angles have few decimals in degrees: they are rounded outwards, by less than half a step.
 */
export function sectorOf(sweep: Sweep, first: number, last: number): Sector {
  const step = inDegrees(Math.abs(sweep.angleIncrement));
  const unit = [10, 100, 1000].find((parts) => 1 / parts <= step / 2 || step === 0) ?? 10_000;
  const ends = [first, last].map((index) => inDegrees(angleOf(sweep, index)) * unit) as [number, number];
  let low = Math.floor(Math.min(...ends) + LOST * unit);
  let high = Math.ceil(Math.max(...ends) - LOST * unit);
  if (low === high) [low, high] = [low - 1, high + 1];
  if (high - low >= 360 * unit) return { start: -180 * DEGREE, end: 180 * DEGREE };
  const half = 180 * unit;
  const toRadians = (angle: number) => ((modulo(angle + half - 1, 2 * half) - half + 1) / unit) * DEGREE;
  return { start: toRadians(low), end: toRadians(high) };
}

const PART = /^\s*(?:(?:msg\.|scan\.)?ranges\s*)?\[\s*(-?\d{1,7})?\s*(:)?\s*(-?\d{1,7})?\s*\]\s*$/;

/**
 * The stretches that a text names: slices and single indices, joined by "+"; null for any other text. They may be
 * empty, and may lie beyond the array.
 */
export function parseRays(text: string, count: number): Stretch[] | null {
  const found: Stretch[] = [];
  for (const part of text.split("+")) {
    const match = PART.exec(part);
    if (!match || (!match[2] && (!match[1] || match[3]))) return null;
    const [first, last] = [match[1], match[3]].map((digits) => (digits ? Number(digits) : null));
    const fromStart = (index: number) => (index < 0 ? index + count : index);
    const start = fromStart(first ?? 0);
    found.push([start, match[2] ? fromStart(last ?? count) : start + 1]);
  }
  return found;
}
