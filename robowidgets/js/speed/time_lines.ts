import type { AxisFacts, GroupFacts } from "./facts.ts";
import type { Speeds } from "./frame.ts";
import { judge } from "./limits.ts";
import type { Limits } from "./traits.ts";

/** A speed at a time; NaN where there is no value. */
export interface Point {
  /** Milliseconds before the last sample: 0 or less. */
  at: number;
  value: number;
}

/** What one axis did in the last seconds. */
export interface TimeLine {
  facts: AxisFacts;
  measured: Point[];
  commanded: Point[];
  /** From when to when the measured speed was past a limit. */
  over: [number, number][];
}

/** A sample with the time of its arrival in milliseconds. */
export interface Timed {
  at: number;
  frame: Pick<Speeds, "measured" | "commanded">;
}

/** Milliseconds between samples from which on a line is broken, as the source is silent. */
const GAP = 1000;

/** The lines of all axes on show. Samples whose time is unknown, as they came before the page was loaded, are left out. */
export function toTimeLines(samples: Timed[], groups: GroupFacts[], seconds: number): TimeLine[] {
  const end = samples.at(-1)?.at ?? NaN;
  const recent = samples.filter(({ at }) => end - at <= 1000 * seconds);
  return groups.flatMap(({ axes }) =>
    axes.map((facts) => {
      const of = (name: "measured" | "commanded"): Point[] =>
        recent.map(({ at, frame }) => ({ at: at - end, value: frame[name]?.[facts.axis.index] ?? NaN }));
      const measured = of("measured");
      return { facts, measured, commanded: of("commanded"), over: spansOver(measured, facts.limits) };
    }),
  );
}

/** The runs of points, without those that have no value; a silence ends a run. */
export function toRuns(points: Point[]): Point[][] {
  const runs: Point[][] = [];
  let before = NaN;
  for (const point of points) {
    if (Number.isNaN(point.value)) before = NaN;
    else {
      if (point.at - before <= GAP) runs.at(-1)?.push(point);
      else runs.push([point]);
      before = point.at;
    }
  }
  return runs;
}

/** The spans in which a speed is past its limits: from the first sample that is, to the first one that is not. */
export function spansOver(points: Point[], limits: Limits | null): [number, number][] {
  const spans: [number, number][] = [];
  for (const run of toRuns(points)) {
    let start: number | null = null;
    for (const { at, value } of run) {
      const isOver = ["over", "under"].includes(judge(value, limits));
      if (isOver && start === null) start = at;
      if (!isOver && start !== null) {
        spans.push([start, at]);
        start = null;
      }
    }
    if (start !== null) spans.push([start, run.at(-1)?.at ?? start]);
  }
  return spans;
}

/** The point at a time, which holds until the next; null before the first. */
export function pointAt(points: Point[], at: number): Point | null {
  return points.filter((point) => point.at <= at).at(-1) ?? points[0] ?? null;
}
