import { type RayLabel, rayIndices, rayLabels } from "../../robowidgets/js/laser/guides.ts";
import { classify, type Scan, type Sweep, takeCensus } from "../../robowidgets/js/shared/frames/scan.ts";
import type { Projection } from "../../robowidgets/js/shared/projection.ts";
import { FORWARD, fit, sweepRim } from "../../robowidgets/js/shared/projection.ts";

export const DEGREE = Math.PI / 180;

/** A sweep in degrees, centred on forward unless the first angle is given. */
export function sweepOf(spread: number, count: number, first = -spread / 2): Sweep {
  return {
    angleMin: first * DEGREE,
    angleIncrement: count > 1 ? (spread * DEGREE) / (count - 1) : 0,
    count,
  };
}

export const circle = (count = 360, first = -180): Sweep => ({
  angleMin: first * DEGREE,
  angleIncrement: (360 / count) * DEGREE,
  count,
});

/** The sweeps of common scanners. */
export const SWEEPS: Record<string, Sweep> = {
  "360 degrees from behind": circle(),
  "360 degrees from forward": circle(360, 0),
  "360 degrees with the end ray repeated": sweepOf(360, 361),
  "360 degrees clockwise": { angleMin: 0, angleIncrement: -DEGREE, count: 360 },
  "270 degrees": sweepOf(270, 1081),
  "239 degrees": sweepOf(239, 682),
  "180 degrees": sweepOf(180, 181),
  "180 degrees clockwise": { angleMin: 90 * DEGREE, angleIncrement: -DEGREE, count: 181 },
  "60 degrees": sweepOf(60, 61),
  "60 degrees to the left": sweepOf(60, 61, 60),
  "1 degree": sweepOf(1, 5),
  "one ray": sweepOf(0, 1),
  "one ray behind": sweepOf(0, 1, 180),
};

/** The view's box in a narrow and in a wide notebook. */
export const BOXES = [
  { x: 0, y: 0, width: 320, height: 243 },
  { x: 0, y: 30, width: 280, height: 213 },
  { x: 0, y: 0, width: 760, height: 540 },
  { x: 0, y: 0, width: 1200, height: 300 },
];

export function scanOf(values: number[], more: Partial<Scan> = {}): Scan {
  const ranges = Float32Array.from(values);
  const { minRange = Math.fround(0.1), maxRange = 30 } = more;
  const kinds = Array.from(ranges, (range) => classify(range, minRange, maxRange));
  return {
    sequence: 1,
    rate: Number.NaN,
    arrived: 0,
    angleMin: -0.5,
    angleIncrement: 0.5,
    count: ranges.length,
    minRange,
    maxRange,
    ranges,
    kinds,
    ...takeCensus(ranges, kinds, minRange),
    intensities: new Float32Array(0),
    sources: new Float32Array(0),
    ...more,
  };
}

/** Widths of the two lines of a label, about as wide as a browser makes them. */
export const measure = (lines: [string, string]): number => Math.max(...lines.map((line) => line.length)) * 7;

/** The layout of the scene for a sweep: the projection and all its labels. */
export function layOut(
  sweep: Sweep,
  box = BOXES[0] as (typeof BOXES)[number],
  viewRange = 10,
  forward = "up",
  rayCount: number | null = 9,
): { projection: Projection; labels: RayLabel[] } {
  const turn = FORWARD[forward] as number;
  const labels = rayLabels(sweep, rayIndices(sweep, [], rayCount), turn, measure);
  return { projection: { ...fit([...sweepRim(sweep, turn), ...labels], box), viewRange, forward: turn }, labels };
}

/** Pseudo-random numbers from 0 to 1, the same at every run. */
export function randoms(seed: number): () => number {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

export function near(actual: number, expected: number, tolerance = 1e-9): boolean {
  return Math.abs(actual - expected) <= tolerance;
}
