import { READING, type Scan } from "../shared/frames/scan.ts";

/** The percentiles between which nine of ten readings of a ray lie. Python has the same. */
const [LOW, HIGH] = [0.05, 0.95];

/** For each ray, the metres between which its readings lie; NaN for fewer than two. */
export interface Spread {
  low: Float64Array;
  high: Float64Array;
  /** Number of scans. */
  count: number;
}

/** The scatter of the readings of each ray over the scans that have as many rays as the last one. */
export function spreadOf(scans: Scan[]): Spread {
  const rays = scans.at(-1)?.count ?? 0;
  const alike = scans.filter(({ count }) => count === rays);
  const [low, high] = [new Float64Array(rays).fill(NaN), new Float64Array(rays).fill(NaN)];
  const readings = new Float32Array(alike.length);
  for (let i = 0; i < rays; i++) {
    let count = 0;
    for (const { kinds, ranges } of alike) if (kinds[i] === READING) readings[count++] = ranges[i] as number;
    if (count < 2) continue;
    const sorted = readings.subarray(0, count).sort();
    low[i] = percentile(sorted, LOW);
    high[i] = percentile(sorted, HIGH);
  }
  return { low, high, count: alike.length };
}

/** Metres by which the readings of a ray scatter, the same as Python's `spread`. */
export function spreadAt({ low, high }: Spread, index: number): number {
  return ((high[index] ?? NaN) - (low[index] ?? NaN)) / 2;
}

/** A percentile of at least two sorted numbers. */
function percentile(sorted: Float32Array, share: number): number {
  const place = share * (sorted.length - 1);
  const below = Math.floor(place);
  const [low, high] = [sorted[below] as number, sorted[below + 1] as number];
  return low + (place - below) * (high - low);
}
