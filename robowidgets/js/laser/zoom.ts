import { classify, READING, type Scan } from "./scan.ts";

/** How far the picture reaches: "sensor" (range_max), "data" (fit to the readings), or metres. */
export type ViewRange = "sensor" | "data" | number;

const STEPS = [1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10];
const CLOSEST = 0.05;

/** The smallest round number of metres that is at least this. */
export function roundUp(metres: number): number {
  const power = 10 ** Math.floor(Math.log10(metres));
  const step = STEPS.find((s) => s * power >= metres * (1 - 1e-9)) ?? 10;
  return Number((step * power).toPrecision(6));
}

/** One step nearer (-1) or farther (+1) in round numbers, within what the sensor can see. */
export function stepRange(metres: number, direction: -1 | 1, rangeMax: number): number {
  if (direction > 0) return Math.min(rangeMax, roundUp(metres * 1.01));
  const power = 10 ** Math.floor(Math.log10(metres * 0.99));
  const below = STEPS.filter((s) => s * power <= metres * 0.99).at(-1) ?? 1;
  return Math.max(CLOSEST, Number((below * power).toPrecision(6)));
}

/** Distance within which all but the farthest 2 % of the readings lie; 0 without readings. */
export function reach(scan: Scan): number {
  const readings = scan.ranges.filter((r) => classify(r, scan.rangeMin, scan.rangeMax) === READING).sort();
  return readings[Math.ceil(readings.length * 0.98) - 1] ?? 0;
}

/** A range that fits the readings and keeps still: it grows when they need it, shrinks only when they need far less. */
export function fitRange(previous: number, scan: Scan): number {
  const needed = reach(scan) * 1.05;
  if (needed === 0) return previous || scan.rangeMax;
  if (previous && needed <= previous && needed > previous * 0.5) return previous;
  return Math.min(scan.rangeMax, roundUp(needed));
}

/** The metres to show for a setting; `fitted` is what "data" showed last, or 0. */
export function resolveRange(setting: ViewRange, scan: Scan | null, fitted: number): number {
  if (typeof setting === "number") return setting;
  if (!scan) return fitted || 10;
  return setting === "data" ? fitRange(fitted, scan) : scan.rangeMax;
}
