import { silentAfter, usualStep } from "./staleness.ts";

/** A value at a time; NaN if it is missing. */
export interface Point {
  /** Milliseconds before the sample on show: 0 or less. */
  at: number;
  value: number;
}

/** One value over the last seconds, and the row in which it is drawn. */
export interface TimeLine {
  name: string;
  /** Label at the side of the line. */
  label: string;
  /** The ends of the scale. */
  low: number;
  high: number;
  /** True if the ends stand at the side of the line. */
  showsEnds: boolean;
  decimals: number;
  limits: number[];
  color: "pointer" | "own";
  measured: Point[];
  /** The commanded values, drawn as steps. */
  commanded: Point[];
  /** Start and end of the spans in which the value was past a limit. */
  over: [number, number][];
}

/** The runs of points with values; a silence of the source ends a run. */
export function toRuns(points: Point[]): Point[][] {
  const runs: Point[][] = [];
  const longest = silentAfter(usualStep(points.map(({ at }) => at)));
  let before = NaN;
  for (const point of points) {
    if (Number.isNaN(point.value)) before = NaN;
    else {
      if (point.at - before <= longest) runs.at(-1)?.push(point);
      else runs.push([point]);
      before = point.at;
    }
  }
  return runs;
}

/** The point at a time, which holds until the next; null before the first. */
export function pointAt(points: Point[], at: number): Point | null {
  return points.filter((point) => point.at <= at).at(-1) ?? points[0] ?? null;
}
