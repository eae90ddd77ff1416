import type { Point } from "../laser/projection.ts";
import type { Size } from "../shared/canvas.ts";

const GAP = 14;
const MARGIN = 4;

/** Where a pop-up goes: right of what it names where there is room, else left of it; always inside. */
export function placeBeside(popup: Size, inside: Size, at: Point): Point {
  const right = at.x + GAP;
  const left = at.x - GAP - popup.width;
  const fits = right + popup.width <= inside.width - MARGIN;
  const x = fits ? right : Math.max(MARGIN, left);
  const y = at.y - popup.height - GAP / 2;
  return { x, y: Math.min(inside.height - popup.height - MARGIN, Math.max(MARGIN, y)) };
}
