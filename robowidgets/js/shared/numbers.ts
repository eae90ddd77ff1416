import { decimalsFor } from "./format.ts";
import type { Point, TimeLine } from "./time_lines.ts";
import type { Moment } from "./traits.ts";

/** Seconds that are shown. */
export const SECONDS = 10;

/** Part of the scale that is left free above and below a line. */
const ROOM = 0.1;

/**
 * The numbers that a program plotted in the last seconds, only those whose names are still in use; each sample has at
 * most one.
 *
 * @param also gives more numbers of a sample
 */
export function toNumberLines<M extends Pick<Moment, "about" | "at">>(
  samples: M[],
  also: ((moment: M) => Record<string, number | null>) | null = null,
): TimeLine[] {
  const last = samples.at(-1);
  const recent = samples
    .filter(({ at }) => last && last.at - at <= 1000 * SECONDS)
    .map((moment) => ({ at: moment.at, numbers: { ...moment.about.numbers, ...also?.(moment) } }));
  return Object.keys(recent.at(-1)?.numbers ?? {}).map((name) => {
    const measured = recent.flatMap(({ numbers, at }): Point[] => {
      const value = numbers[name] ?? null;
      return value === null ? [] : [{ at: at - (last?.at ?? 0), value }];
    });
    return {
      name,
      label: short(name),
      ...scaleOf(measured),
      color: "own",
      limits: [],
      measured,
      commanded: [],
      over: [],
    };
  });
}

const LONGEST = 14;

function short(name: string): string {
  if (name.length <= LONGEST) return name;
  // The end of a path has the most information.
  return name.includes(".") ? `\u2026${name.slice(1 - LONGEST)}` : `${name.slice(0, LONGEST - 1)}\u2026`;
}

function scaleOf(points: Point[]): Pick<TimeLine, "low" | "high" | "showsEnds" | "decimals"> {
  const values = points.map(({ value }) => value);
  const [least, most] = values.length ? [Math.min(...values), Math.max(...values)] : [0, 1];
  const room = ROOM * (most - least || Math.abs(most) || 1);
  return {
    low: least - room,
    high: most + room,
    showsEnds: values.length > 1,
    decimals: decimalsFor(most - least || Math.abs(most) || 1),
  };
}
