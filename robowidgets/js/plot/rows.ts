import { firstWhere } from "../shared/search.ts";
import type { Span } from "../shared/time_axis.ts";
import type { Rows } from "./frame.ts";

/** A value at its own time. */
export interface Reading {
  time: number;
  /** NaN where the line has no value at that time. */
  value: number;
}

/** Measures of all values in a span, also of values that the page lacks. */
export interface Measures {
  least: number;
  mean: number;
  most: number;
}

/** The rows of a line: inside the span of a part its rows, and outside the rows of the whole line. */
export function merged(all: Rows, part: Rows, [start, end]: Span): Rows {
  const before = firstWhere(all.times, (time) => time >= start);
  const after = firstWhere(all.times, (time) => time > end);
  const low = firstWhere(part.times, (time) => time >= start);
  const high = firstWhere(part.times, (time) => time > end);
  const join = (whole: Float64Array, own: Float64Array) =>
    concat(whole.subarray(0, before), own.subarray(low, high), whole.subarray(after));
  return {
    total: all.total,
    times: join(all.times, part.times),
    values: join(all.values, part.values),
    counts: join(all.counts, part.counts),
    sums: join(all.sums, part.sums),
  };
}

function concat(...parts: Float64Array[]): Float64Array {
  const whole = new Float64Array(parts.reduce((length, part) => length + part.length, 0));
  let at = 0;
  for (const part of parts) {
    whole.set(part, at);
    at += part.length;
  }
  return whole;
}

/** The last value up to a time; null before the first. It is never interpolated. */
export function readingAt({ times, values, counts }: Rows, time: number): Reading | null {
  let at = firstWhere(times, (one) => one > time) - 1;
  while (at >= 0 && (counts[at] as number) < 0) at--;
  return at < 0 ? null : { time: times[at] as number, value: values[at] as number };
}

/** The time of the next value, or of the previous one; undefined if there is none. */
export function timeBeside({ times, counts }: Rows, time: number, by: number): number | undefined {
  const step = by < 0 ? -1 : 1;
  let left = Math.abs(by);
  let found: number | undefined;
  let at = by < 0 ? firstWhere(times, (one) => one >= time) - 1 : firstWhere(times, (one) => one > time);
  for (; left > 0 && at >= 0 && at < times.length; at += step) {
    if ((counts[at] as number) < 0) continue;
    found = times[at];
    left--;
  }
  return found;
}

/** The least, the mean and the greatest of the values in a span; null without a value. */
export function measure({ times, values, counts, sums }: Rows, [start, end]: Span): Measures | null {
  let [least, most, sum, count] = [Infinity, -Infinity, 0, 0];
  const first = firstWhere(times, (time) => time >= start);
  const stop = firstWhere(times, (time) => time > end);
  for (let i = first; i < stop; i++) {
    const value = values[i] as number;
    // The values that the first row stands for lie before the span.
    const isFirst = i === first;
    sum += isFirst ? value || 0 : (sums[i] as number);
    count += isFirst ? Number(!Number.isNaN(value)) : Math.max(0, counts[i] as number);
    if (value < least) least = value;
    if (value > most) most = value;
  }
  return count ? { least, mean: sum / count, most } : null;
}
