import { firstWhere } from "../shared/search.ts";
import { type Block, NO_SCAN } from "./data.ts";
import type { Rows } from "./rows.ts";
import type { Span } from "./traits.ts";

/** Codes of a picture, line after line from the top: what each pixel shows. */
export interface Raster {
  width: number;
  height: number;
  codes: Uint16Array;
}

/**
 * The picture of a span, each column from the finest block that covers it. Where several scans or rays share a pixel,
 * the least code is shown, so that the nearest distance does not vanish.
 *
 * @param blocks the finest first
 * @param height at most so many lines; fewer where there are fewer rays
 */
export function toRaster(blocks: Block[], rows: Rows, span: Span, width: number, height: number): Raster {
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

/** The cells of the finest block that knows a time; null where there is none. */
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

function merge({ codes, rays }: Block, first: number, stop: number, lineOfRay: Uint16Array, column: Uint16Array): void {
  column.fill(NO_SCAN);
  for (let at = first * rays, cell = first; cell < stop; cell++) {
    for (let ray = 0; ray < rays; ray++, at++) {
      const [line, code] = [lineOfRay[ray] as number, codes[at] as number];
      if (code < (column[line] as number)) column[line] = code;
    }
  }
}
