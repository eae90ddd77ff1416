import type { Box, Point } from "../box.ts";
import { write } from "../canvas.ts";
import type { Theme } from "../theme.ts";
import type { Shape } from "../traits.ts";

export const LINE = 15;
/** Pixels between a shape and its words, best first. */
const GAPS = [8, 18, 30];
/** Places along a shape for its words, best first. */
const ALONG = [0.5, 0.3, 0.7, 0.1, 0.9];
/** Sides of a shape for its words, to the right and downwards, best first. */
const SIDES = [
  [1, 0],
  [-1, 0],
  [0, -1],
  [0, 1],
  [1, -1],
  [-1, -1],
  [1, 1],
  [-1, 1],
];
export const PLACES = GAPS.length * ALONG.length * SIDES.length;

/**
 * A box for words next to a shape, `PLACES` of them, best first; null if all of it is out of view. A text stands on the
 * place that the program has chosen, if it can.
 */
export function boxAt(path: Point[], width: number, height: number, place: number, isText = false): Box | null {
  const perGap = ALONG.length * SIDES.length;
  const part = ALONG[Math.floor(place / SIDES.length) % ALONG.length] as number;
  const gap = GAPS[Math.floor(place / perGap)] as number;
  const point = path[Math.round(part * (path.length - 1))];
  if (!point) return null;
  const [right, down] = isText && place === 0 ? [0, 0] : (SIDES[place % SIDES.length] as [number, number]);
  const x = point.x + (right > 0 ? gap : right < 0 ? -gap - width : -width / 2);
  const y = point.y + (down > 0 ? gap : down < 0 ? -gap - height : -height / 2);
  return { x, y, width, height };
}

function fontOf(line: number, theme: Theme): string {
  return `${line ? "" : "650 "}12px ${theme.font}`;
}

export function widthOf(context: CanvasRenderingContext2D, text: string, line: number, theme: Theme): number {
  context.font = fontOf(line, theme);
  return context.measureText(text).width;
}

export function writeLabel(
  context: CanvasRenderingContext2D,
  box: Box,
  lines: string[],
  shape: Shape,
  theme: Theme,
): void {
  for (const [i, line] of lines.entries()) {
    const y = box.y + LINE * (i + 0.5);
    write(context, line, box.x, y, shape.color ?? theme.own, fontOf(i, theme), "left", theme.area);
  }
}
