import { copyOf, toBytes } from "../shared/bytes.ts";
import type { Span } from "../shared/time_axis.ts";

/** Values of a line in the order of time, with the counts between them. */
export interface Rows {
  times: Float64Array;
  /** NaN for a missing value. */
  values: Float64Array;
  /** Number of values after the previous row, up to this one; -1 for a silence instead of a value. */
  counts: Float64Array;
  /** The sum of these. */
  sums: Float64Array;
  /** Number of all values of the line. */
  total: number;
}

/** Lines as they show a span in so many columns of pixels. */
export interface PlotFrame {
  /** Edition of the lines: frames of different editions do not fit together. */
  edition: number;
  /** The first and the last time of all lines. */
  whole: Span;
  span: Span;
  columns: number;
  lines: Rows[];
}

const HEAD = 7;
const DOUBLE = 8;

/** Decodes the frame that `robowidgets/plots/frame.py` packs; null for an empty trait. */
export function decodePlot(trait: unknown): PlotFrame | null {
  const bytes = toBytes(trait);
  if (!bytes) return null;
  const all = new Float64Array(copyOf(bytes, 0, bytes.byteLength - (bytes.byteLength % DOUBLE)));
  const [edition = 0, first = 0, last = 0, start = 0, end = 0, columns = 1, count = 0] = all;
  let at = HEAD;
  const take = (length: number) => {
    at += length;
    return all.subarray(at - length, at);
  };
  const lines = Array.from({ length: count }, () => {
    const [total = 0, rows = 0] = take(2);
    return { total, times: take(rows), values: take(rows), counts: take(rows), sums: take(rows) };
  });
  return { edition, whole: [first, last], span: [start, end], columns, lines };
}
