import type { Speeds } from "../shared/frames/speeds.ts";
import { type Point, type TimeLine, toRuns } from "../shared/time_lines.ts";
import { toLabel } from "./axes.ts";
import type { GroupFacts } from "./facts.ts";
import { judge } from "./limits.ts";
import type { Limits } from "./traits.ts";

/** A sample with the time of its arrival in milliseconds. */
interface Timed {
  at: number;
  frame: Pick<Speeds, "measured" | "commanded">;
}

/** The lines of all axes on show. Samples without a known time, from before the page was loaded, are left out. */
export function toTimeLines(samples: Timed[], groups: GroupFacts[], seconds: number): TimeLine[] {
  const end = samples.at(-1)?.at ?? NaN;
  const recent = samples.filter(({ at }) => end - at <= 1000 * seconds);
  return groups.flatMap(({ axes }) =>
    axes.map((facts) => {
      const of = (name: "measured" | "commanded"): Point[] =>
        recent.map(({ at, frame }) => ({ at: at - end, value: frame[name]?.[facts.axis.index] ?? NaN }));
      const measured = of("measured");
      const { axis, scale, limits, decimals } = facts;
      return {
        name: axis.name,
        label: toLabel(axis),
        ...{ low: scale.low, high: scale.high, showsEnds: false, decimals, limits: limits ?? [], color: "pointer" },
        ...{ measured, commanded: of("commanded"), over: spansOver(measured, limits) },
      };
    }),
  );
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
