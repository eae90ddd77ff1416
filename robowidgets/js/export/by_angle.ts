/** The rays of a scan: radians, and their number. */
export interface Rays {
  angleMin: number;
  angleIncrement: number;
  count: number;
}

const TURN = 2 * Math.PI;

/**
 * For each ray of `on` the index of the nearest ray of `of`, as `scanogram/by_angle.py` finds it.
 * @returns -1 where no ray points there
 */
export function raysAt(of: Rays, on: Rays): Int32Array {
  const step = Math.abs(of.angleIncrement) || Math.abs(on.angleIncrement);
  const sign = of.angleIncrement < 0 ? -1 : 1;
  return Int32Array.from({ length: on.count }, (_, ray) => {
    const ahead = (on.angleMin + ray * on.angleIncrement - of.angleMin) * sign + step / 2;
    const isKnown = ahead >= 0 && ahead < of.count * step;
    // An angle outside of the sweep may lie in it a full turn later.
    const later = ahead % TURN;
    const index = Math.floor((isKnown ? ahead : later < 0 ? later + TURN : later) / (step || 1));
    return index < of.count ? index : -1;
  });
}

/** Ranges in metres on the rays of another sweep; NaN where no ray points. A scan with more rays has none there. */
export function onRays(ranges: Float32Array, of: Rays, on: Rays): Float32Array {
  if (of.count === on.count && of.angleMin === on.angleMin && of.angleIncrement === on.angleIncrement) return ranges;
  if (!of.count || of.count > on.count) return new Float32Array(on.count).fill(NaN);
  return Float32Array.from(raysAt(of, on), (index) => (index < 0 ? NaN : (ranges[index] as number)));
}
