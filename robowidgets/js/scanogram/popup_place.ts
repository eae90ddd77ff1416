import type { Point } from "../shared/box.ts";
import type { Size } from "../shared/canvas.ts";

const GAP = 14;
const MARGIN = 4;

/** Place of a pop-up: right of the thing it names if there is room, else left of it; always inside the picture. */
export function placeBeside(popup: Size, inside: Size, at: Point): Point {
  const right = at.x + GAP;
  const left = at.x - GAP - popup.width;
  const fits = right + popup.width <= inside.width - MARGIN;
  const x = fits ? right : Math.max(MARGIN, left);
  const y = at.y - popup.height - GAP / 2;
  return { x, y: Math.min(inside.height - popup.height - MARGIN, Math.max(MARGIN, y)) };
}
