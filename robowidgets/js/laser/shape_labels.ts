import { writeOver } from "../shared/canvas.ts";
import type { Theme } from "../shared/theme.ts";
import type { Shape } from "../shared/traits.ts";
import { overlaps } from "./guides.ts";
import type { Stage } from "./layer.ts";
import type { Box, Point } from "./projection.ts";

/** The words of a shape, and points of the picture along it. */
export interface ShapeLabel {
  shape: Shape;
  path: Point[];
  /** The name, and below it the numbers, if there are any. */
  lines: string[];
}

const LINE = 15;
/** Pixels between a shape and its words, best first. */
const GAPS = [8, 18, 30];
const ROBOT = 10;
/** Where along a shape its words may stand, best first. */
const ALONG = [0.5, 0.3, 0.7, 0.1, 0.9];

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
      write(context, found.box, found.lines, label.shape, theme);
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
    const free = (box: Box) =>
      isWithin(box, stage.box) &&
      stage.occupied.count(box) === 0 &&
      ![robot, ...stage.labels, ...stage.covered].some((other) => overlaps(box, other, 2));
    for (let count = lines.length; count > 0; count--) {
      const shown = lines.slice(0, count);
      const width = Math.max(...shown.map((line, i) => widthOf(context, line, i, theme)));
      const beside = placesFor(path, width, LINE * count);
      // A text stands on the place that the program has chosen, if it can.
      const boxes = shape.kind === "text" ? [...onPlace(path, width), ...beside] : beside;
      const order = before === undefined ? boxes.keys() : [before, ...boxes.keys()];
      for (const place of order) {
        const box = boxes[place];
        if (box && free(box)) return { box, place, lines: shown };
      }
    }
    return null;
  }
}

function onPlace(path: Point[], width: number): Box[] {
  return path.map(({ x, y }) => ({ x: x - width / 2, y: y - LINE / 2, width, height: LINE }));
}

/** Boxes beside a shape, best first. */
export function placesFor(path: Point[], width: number, height: number): Box[] {
  const points = ALONG.flatMap((part) => path[Math.round(part * (path.length - 1))] ?? []);
  return GAPS.flatMap((gap) => points.flatMap((point) => boxesAt(point, gap, width, height)));
}

function boxesAt({ x, y }: Point, gap: number, width: number, height: number): Box[] {
  const [left, right] = [x - gap - width, x + gap];
  const [above, below] = [y - gap - height, y + gap];
  return [
    { x: right, y: y - height / 2 },
    { x: left, y: y - height / 2 },
    { x: x - width / 2, y: above },
    { x: x - width / 2, y: below },
    { x: right, y: above },
    { x: left, y: above },
    { x: right, y: below },
    { x: left, y: below },
  ].map((corner) => ({ ...corner, width, height }));
}

function isWithin(inner: Box, outer: Box): boolean {
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

function widthOf(context: CanvasRenderingContext2D, text: string, line: number, theme: Theme): number {
  context.font = fontOf(line, theme);
  return context.measureText(text).width;
}

function write(context: CanvasRenderingContext2D, box: Box, lines: string[], shape: Shape, theme: Theme): void {
  for (const [i, line] of lines.entries()) {
    const y = box.y + LINE * (i + 0.5);
    writeOver(context, line, box.x, y, shape.color ?? theme.own, fontOf(i, theme), "left", theme.area);
  }
}
