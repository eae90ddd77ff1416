import { copyOf, toBytes } from "../shared/bytes.ts";
import type { Span } from "../shared/time_axis.ts";

/** Values of a line in the order of time, and what lies between them. */
export interface Rows {
  times: Float64Array;
  /** NaN where there is none. */
  values: Float64Array;
  /** How many values there are after the row before, up to this one; -1: no value, but a silence. */
  counts: Float64Array;
  /** The sum of these. */
  sums: Float64Array;
  /** How many values the line has in all. */
  total: number;
}

/** Lines as they show a span in so many columns of pixels. */
export interface PlotFrame {
  /** Of the lines: what is of different editions does not fit together. */
  edition: number;
  /** The first and the last time of all lines. */
  whole: Span;
  span: Span;
  columns: number;
  lines: Rows[];
}

const HEAD = 7;
const DOUBLE = 8;

/** Decodes what `robowidgets/plotting/frame.py` packs; null where there is nothing. */
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
