import { FARTHEST_VIEW, NO_LIMIT, READING, type Scan } from "../shared/frames/scan.ts";
import { roundUp } from "../shared/zoom.ts";
import type { ViewRange } from "./traits.ts";

/** Metres shown by a picture without a scan or a limit. */
const EMPTY = 10;

/** Distance within which all but the farthest 2 % of the readings lie; 0 without readings. */
export function reach(scan: Scan): number {
  const readings = scan.ranges.filter((_, i) => scan.kinds[i] === READING).sort();
  return readings[Math.ceil(readings.length * 0.98) - 1] ?? 0;
}

/** A range that fits the readings and keeps still: it grows if they need it, and shrinks only if they need far less. */
export function fitRange(previous: number, scan: Scan): number {
  const needed = reach(scan) * 1.05;
  if (needed === 0) return previous || (scan.maxRange > NO_LIMIT ? EMPTY : scan.maxRange);
  if (previous && needed <= previous && needed > previous * 0.5) return previous;
  return Math.min(scan.maxRange, FARTHEST_VIEW, roundUp(needed));
}

/** Returns true if the picture reaches as far as the readings. */
export function fitsReadings(setting: ViewRange, maxRange = 0): boolean {
  return setting === "data" || (setting === "sensor" && maxRange > NO_LIMIT);
}

/** The setting that "auto" becomes with this scan; null, and it stays "auto", for a scan without readings. */
export function decideRange(scan: Scan): "data" | "sensor" | null {
  const metres = reach(scan);
  if (metres === 0) return null;
  return metres < scan.maxRange / 3 ? "data" : "sensor";
}

/** The metres to show for a setting; `fitted` is the range that last fitted the readings, or 0. */
export function resolveRange(setting: ViewRange, scan: Scan | null, fitted: number): number {
  if (typeof setting === "number") return setting;
  if (!scan) return fitted || EMPTY;
  return fitsReadings(setting, scan.maxRange) ? fitRange(fitted, scan) : scan.maxRange;
}
