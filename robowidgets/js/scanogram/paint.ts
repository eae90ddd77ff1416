import { firstWhere } from "../shared/search.ts";
import type { Span } from "../shared/time_axis.ts";
import { type Block, NO_SCAN } from "./data.ts";
import type { Rows } from "./rows.ts";
import type { Pixel } from "./traits.ts";

/** Codes of a picture, line after line from the top: one for each pixel. */
interface Raster {
  width: number;
  height: number;
  codes: Uint16Array;
}

/** Merges the codes of each pixel of a column into one: cells `first` to `stop - 1` of a block. */
type Merge = (block: Block, first: number, stop: number, lineOfRay: Uint16Array, column: Uint16Array) => void;

/**
 * The picture of a span, each column from the finest block that covers it. If several scans or rays share a pixel,
 * the least code is shown, so that the nearest distance does not vanish; or the median.
 *
 * @param blocks the finest first
 * @param height at most so many lines; fewer if there are fewer rays
 */
export function toRaster(
  blocks: Block[],
  rows: Rows,
  span: Span,
  width: number,
  height: number,
  pixel: Pixel = "nearest",
): Raster {
  const merge = pixel === "median" ? medians() : nearest;
  const rayCount = rows.rowOf.length;
  const lines = Math.max(1, Math.min(rayCount, height));
  const codes = new Uint16Array(width * lines).fill(NO_SCAN);
  const column = new Uint16Array(lines);
  const perColumn = (span[1] - span[0]) / width;
  const lineOf = new Map<number, Uint16Array>();
  let shown: { block: Block; first: number; stop: number } | null = null;
  for (let x = 0; x < width; x++) {
    const from = span[0] + x * perColumn;
    const found = cellsIn(blocks, from, from + perColumn);
    if (!found) continue;
    const { block, first, stop } = found;
    if (!shown || shown.block !== block || shown.first !== first || shown.stop !== stop) {
      const lineOfRay = lineOf.get(block.rayStep) ?? toLines(rows, block, lines);
      lineOf.set(block.rayStep, lineOfRay);
      merge(block, first, stop, lineOfRay, column);
      shown = found;
    }
    for (let line = 0, at = x; line < lines; line++, at += width) codes[at] = column[line] as number;
  }
  return { width, height: lines, codes };
}

/** The cells of the finest block that has a time; null if all lack it. */
function cellsIn(blocks: Block[], from: number, to: number): { block: Block; first: number; stop: number } | null {
  for (const block of blocks) {
    const { startsAt, endsAt } = block;
    const knows = from >= (startsAt[0] as number) && to <= (endsAt.at(-1) as number);
    if (!knows && block !== blocks.at(-1)) continue;
    const first = firstWhere(endsAt, (end) => end > from);
    const stop = firstWhere(startsAt, (start) => start >= to);
    if (stop > first) return { block, first, stop };
  }
  return null;
}

function toLines(rows: Rows, { rays, rayStep }: Block, lines: number): Uint16Array {
  const count = rows.rowOf.length;
  return Uint16Array.from({ length: rays }, (_, ray) => {
    const row = rows.rowOf[Math.min(count - 1, ray * rayStep)] ?? 0;
    return lines - 1 - Math.floor((row * lines) / count);
  });
}

const nearest: Merge = ({ codes, rays }, first, stop, lineOfRay, column) => {
  column.fill(NO_SCAN);
  for (let at = first * rays, cell = first; cell < stop; cell++) {
    for (let ray = 0; ray < rays; ray++, at++) {
      const [line, code] = [lineOfRay[ray] as number, codes[at] as number];
      if (code < (column[line] as number)) column[line] = code;
    }
  }
};

/** Merges by the median; for an even number, the nearer of the two in the middle. */
function medians(): Merge {
  let known: { lineOfRay: Uint16Array; rays: Uint16Array } | null = null;
  let shared = new Uint16Array(64);
  return ({ codes, rays }, first, stop, lineOfRay, column) => {
    column.fill(NO_SCAN);
    if (known?.lineOfRay !== lineOfRay) {
      const byLine = Uint16Array.from(lineOfRay, (_, ray) => ray).sort((a, b) => at(lineOfRay, a) - at(lineOfRay, b));
      known = { lineOfRay, rays: byLine };
    }
    if (shared.length < (stop - first) * rays) shared = new Uint16Array((stop - first) * rays);
    for (let from = 0; from < rays; ) {
      const line = at(lineOfRay, at(known.rays, from));
      let count = 0;
      let to = from;
      for (; to < rays && at(lineOfRay, at(known.rays, to)) === line; to++) {
        for (let cell = first; cell < stop; cell++) {
          const code = at(codes, cell * rays + at(known.rays, to));
          if (code !== NO_SCAN) count = inserted(shared, count, code);
        }
      }
      if (count) column[line] = at(shared, (count - 1) >> 1);
      from = to;
    }
  };
}

const at = (numbers: Uint16Array, index: number): number => numbers[index] as number;

/** Puts a number into its place among some that are in order; returns how many there are. A pixel has few. */
function inserted(ordered: Uint16Array, count: number, value: number): number {
  let place = count;
  for (; place > 0 && at(ordered, place - 1) > value; place--) ordered[place] = at(ordered, place - 1);
  ordered[place] = value;
  return count + 1;
}
