import { angleOf, indexAt, READING, type Scan, type Sweep, TOO_CLOSE } from "../shared/frames/scan.ts";

/** Metres; a smaller range that is also below range_min is an error code. Python has the same number. */
const CODES_END = 0.0195;
/** Radians within which two sweeps are the same. Python has the same number. */
const SAME_ANGLE = 1e-6;

/** The distance that a ray counts as: metres, 0 for too close, infinity if nothing is in range, NaN if unknown. */
export function distanceOf({ ranges, kinds, minRange, maxRange }: Scan, index: number): number {
  const range = ranges[index] as number;
  if (kinds[index] === READING) return range;
  if (range > maxRange) return Infinity;
  if (kinds[index] === TOO_CLOSE) return 0;
  return range < minRange && range >= CODES_END ? 0 : NaN;
}

/** Returns true if two sweeps have the same rays. */
export function isSameSweep(a: Sweep, b: Sweep): boolean {
  const ends = (sweep: Sweep) => [angleOf(sweep, 0), angleOf(sweep, Math.max(0, sweep.count - 1))];
  const [first, second] = [ends(a), ends(b)];
  return a.count === b.count && first.every((angle, i) => Math.abs(angle - (second[i] as number)) <= SAME_ANGLE);
}

/** By ray of one scan, the index of the same direction in another; -1 if the other one lacks it. */
export function matchRays(now: Sweep, then: Sweep): (index: number) => number {
  return isSameSweep(now, then) ? (index) => index : (index) => indexAt(then, angleOf(now, index));
}

/**
 * By ray, the distance of a scan minus the distance of another: metres, infinite if one of them meets nothing, 0 if
 * both meet nothing, NaN if one is unknown. Python's `scan - other` is the same.
 */
export function difference(now: Scan, then: Scan): Float32Array {
  const match = matchRays(now, then);
  return Float32Array.from({ length: now.count }, (_, i) => {
    const index = match(i);
    const [a, b] = [distanceOf(now, i), index < 0 ? NaN : distanceOf(then, index)];
    return a === b ? 0 : a - b;
  });
}

/** The ray with the largest finite difference; -1 without one. */
export function largest(differences: Float32Array): number {
  let found = -1;
  let most = 0;
  for (const [i, value] of differences.entries()) {
    if (Number.isFinite(value) && Math.abs(value) > most) {
      most = Math.abs(value);
      found = i;
    }
  }
  return found;
}
