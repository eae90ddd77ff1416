import type { Box, Point } from "../shared/box.ts";
import { write } from "../shared/canvas.ts";
import type { Theme } from "../shared/theme.ts";
import type { Shape } from "../shared/traits.ts";
import { overlaps } from "./guides.ts";
import type { Stage } from "./layer.ts";

/** The words of a shape, and points of the picture along it. */
export interface ShapeLabel {
  shape: Shape;
  path: Point[];
  /** The name, and below it the numbers, if there are any. */
  lines: string[];
}

export const LINE = 15;
/** Pixels between a shape and its words, best first. */
const GAPS = [8, 18, 30];
const ROBOT = 10;
/** Where along a shape its words may stand, best first. */
const ALONG = [0.5, 0.3, 0.7, 0.1, 0.9];
/** On which side of it: to the right and downwards, best first. */
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

/** The words of shapes, each in a place of its own. They keep their places as long as these are free. */
export class ShapeLabels {
  #before = new Map<string, number>();

  draw(context: CanvasRenderingContext2D, stage: Stage, labels: ShapeLabel[], theme: Theme): void {
    const before = this.#before;
    this.#before = new Map();
    for (const [i, label] of labels.entries()) {
      const key = `${i} ${label.shape.name}`;
      const found = this.#place(context, stage, label, before.get(key), theme);
      if (!found) continue;
      this.#before.set(key, found.place);
      stage.labels.push(found.box);
      writeLabel(context, found.box, found.lines, label.shape, theme);
    }
  }

  /** A place for all lines, or without one for the name alone. */
  #place(
    context: CanvasRenderingContext2D,
    stage: Stage,
    { shape, path, lines }: ShapeLabel,
    before: number | undefined,
    theme: Theme,
  ): { box: Box; place: number; lines: string[] } | null {
    const { centerX, centerY } = stage.projection;
    const robot = { x: centerX - ROBOT, y: centerY - ROBOT, width: 2 * ROBOT, height: 2 * ROBOT };
    const taken = [robot, ...stage.labels, ...stage.covered];
    const free = (box: Box) =>
      isWithin(box, stage.box) && !taken.some((other) => overlaps(box, other, 2)) && stage.occupied.count(box) === 0;
    for (let count = lines.length; count > 0; count--) {
      const shown = lines.slice(0, count);
      const width = Math.max(...shown.map((line, i) => widthOf(context, line, i, theme)));
      const box = (place: number) => boxAt(path, width, LINE * count, place, shape.kind === "text");
      for (let place = -1; place < PLACES; place++) {
        // First where it stood before.
        const at = place < 0 ? before : place;
        const tried = at === undefined ? null : box(at);
        if (tried && free(tried)) return { box: tried, place: at as number, lines: shown };
      }
    }
    return null;
  }
}

/**
 * A box for words beside a shape, `PLACES` of them, best first; null where nothing of it is in view. A text stands on
 * the place that the program has chosen, if it can.
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

export function isWithin(inner: Box, outer: Box): boolean {
  return (
    inner.x >= outer.x &&
    inner.y >= outer.y &&
    inner.x + inner.width <= outer.x + outer.width &&
    inner.y + inner.height <= outer.y + outer.height
  );
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
