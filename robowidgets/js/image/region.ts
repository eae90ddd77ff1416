/** Statistics of a part of a picture. */
export interface Statistics {
  /** Number of its pixels, and number of those with a value. */
  of: number;
  count: number;
  /** For each channel least, mean, median and greatest value; null without a value. */
  channels: (number[] | null)[];
  isExact: boolean;
  /** True if they are red, green and blue as shown, not the channels of the message. */
  isShown?: boolean;
}

/** First row, row after the last, first column, column after the last. */
export type Region = [top: number, bottom: number, left: number, right: number];

/** A region between two pixels, both in it, within a picture. */
export function regionOf(
  from: { row: number; column: number },
  to: { row: number; column: number },
  rows: number,
  columns: number,
): Region {
  const clamp = (value: number, size: number) => Math.min(size - 1, Math.max(0, Math.floor(value)));
  const [a, b] = [clamp(from.row, rows), clamp(to.row, rows)];
  const [c, d] = [clamp(from.column, columns), clamp(to.column, columns)];
  return [Math.min(a, b), Math.max(a, b) + 1, Math.min(c, d), Math.max(c, d) + 1];
}

/** The statistics of some pixels, channel by channel; NaN is a missing value. */
export function statisticsOf(channels: Float64Array[], isExact: boolean): Statistics {
  const of = channels[0]?.length ?? 0;
  let count = 0;
  for (let i = 0; i < of; i++) if (channels.every((values) => Number.isFinite(values[i]))) count++;
  return { of, count, channels: channels.map(rowOf), isExact };
}

function rowOf(values: Float64Array): number[] | null {
  const sorted = values.filter(Number.isFinite).sort();
  const { length } = sorted;
  if (!length) return null;
  const at = (index: number) => sorted[index] as number;
  const median = (at(Math.floor((length - 1) / 2)) + at(Math.floor(length / 2))) / 2;
  return [at(0), sorted.reduce((sum, value) => sum + value, 0) / length, median, at(length - 1)];
}
