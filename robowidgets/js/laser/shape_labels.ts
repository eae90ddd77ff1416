import { type Box, overlaps, type Point } from "../shared/box.ts";
import { boxAt, LINE, PLACES, widthOf, writeLabel } from "../shared/shapes/labels.ts";
import type { Theme } from "../shared/theme.ts";
import type { Shape } from "../shared/traits.ts";
import { isFree, type Stage } from "./layer.ts";

/** The words of a shape, and points of the picture along it. */
interface ShapeLabel {
  shape: Shape;
  path: Point[];
  /** The name, and below it the numbers, if there are any. */
  lines: string[];
}

const ROBOT = 10;

/** The words of shapes at separate places. They keep their places as long as these are free. */
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

  /** A place for all lines, or, without one, for the name alone. */
  #place(
    context: CanvasRenderingContext2D,
    stage: Stage,
    { shape, path, lines }: ShapeLabel,
    before: number | undefined,
    theme: Theme,
  ): { box: Box; place: number; lines: string[] } | null {
    const { centerX, centerY } = stage.projection;
    const robot = { x: centerX - ROBOT, y: centerY - ROBOT, width: 2 * ROBOT, height: 2 * ROBOT };
    const free = (box: Box) => !overlaps(box, robot, 1) && isFree(stage, box);
    for (let count = lines.length; count > 0; count--) {
      const shown = lines.slice(0, count);
      const width = Math.max(...shown.map((line, i) => widthOf(context, line, i, theme)));
      const box = (place: number) => boxAt(path, width, LINE * count, place, shape.kind === "text");
      for (let place = -1; place < PLACES; place++) {
        // First its previous place.
        const at = place < 0 ? before : place;
        const tried = at === undefined ? null : box(at);
        if (tried && free(tried)) return { box: tried, place: at as number, lines: shown };
      }
    }
    return null;
  }
}
