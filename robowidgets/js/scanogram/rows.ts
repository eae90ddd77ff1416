import { isFullCircle } from "../shared/frames/scan.ts";
import { firstWhere } from "../shared/search.ts";
import type { Sweep } from "./data.ts";

const TURN = 2 * Math.PI;
const ROUNDING = 1e-6;
const DEGREE = Math.PI / 180;
const STEPS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 45, 90];

/** The rays in rows from the bottom up: angles grow upwards. */
export interface Rows {
  /** By row: the index of the ray, and its angle in radians. */
  rayOf: number[];
  angles: number[];
  /** By index: the row. */
  rowOf: number[];
  /** True if the indices belong to the picture alone. */
  byAngle: boolean;
}

/** Rays by the scanner's angles; if they close a circle, forward is in the middle. */
export function toRows({ angleMin, angleIncrement, count, byAngle }: Sweep): Rows {
  const isCircle = isFullCircle({ angleMin, angleIncrement, count });
  const bottom = -Math.PI - ROUNDING;
  const turn = (angle: number) => (isCircle ? angle - TURN * Math.floor((angle - bottom) / TURN) : angle);
  const byIndex = Array.from({ length: count }, (_, i) => turn(angleMin + i * angleIncrement));
  const rayOf = byIndex.map((_, i) => i).sort((a, b) => (byIndex[a] as number) - (byIndex[b] as number));
  const rowOf: number[] = [];
  for (const [row, index] of rayOf.entries()) rowOf[index] = row;
  return { rayOf, angles: rayOf.map((index) => byIndex[index] as number), rowOf, byAngle };
}

/** The rays between two rows: the first, and one after the last. They end where the circle closes, to be one span. */
export function selectedRays({ rayOf }: Rows, from: number, to: number): [number, number] {
  const [first, last] = [rayOf[from] as number, rayOf[to] as number];
  const isSpan = Math.abs(to - from) === Math.abs(last - first);
  const end = isSpan ? last : last < first ? rayOf.length - 1 : 0;
  return [Math.min(first, end), Math.max(first, end) + 1];
}

/** Rows with round angles, at least `apart` pixels from each other in a picture of a height. */
export function angleTicks({ angles }: Rows, height: number, apart: number): number[] {
  const [low = 0, high = 0] = [angles[0], angles.at(-1)];
  if (angles.length < 2) return angles.map((_, row) => row);
  const perDegree = (height * DEGREE) / ((high - low) * (angles.length / (angles.length - 1)));
  const step = (STEPS.find((degrees) => degrees * perDegree >= apart) ?? 90) * DEGREE;
  const half = (high - low) / (angles.length - 1) / 2;
  const [first, last] = [Math.ceil((low - half) / step), Math.floor((high + half) / step)];
  if (last < first) return [];
  const ticks = Array.from({ length: last - first + 1 }, (_, i) => {
    const least = (first + i) * step - half;
    return Math.min(
      firstWhere(angles, (angle) => angle >= least),
      angles.length - 1,
    );
  });
  // With few rays, several round angles have the same nearest one.
  return [...new Set(ticks)];
}
