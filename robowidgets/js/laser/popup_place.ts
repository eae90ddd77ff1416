import type { Size } from "../shared/canvas.ts";
import { type Occupancy, overlaps } from "./guides.ts";
import type { Box, Point } from "./projection.ts";

const GAP = 12;
const MARGIN = 4;

/**
 * Where a pop-up goes: in the box, off the ray it names, and off other readings and pop-ups where it can.
 *
 * @param from the scanner's place, where the ray starts
 * @param to the reading, or where the ray leaves the view
 */
export function placePopup(
  size: Size,
  box: Box,
  from: Point,
  to: Point,
  occupied: Pick<Occupancy, "count">,
  others: Box[],
): Point {
  const { width, height } = size;
  const left = box.x + MARGIN;
  const top = box.y + MARGIN;
  const right = Math.max(left, box.x + box.width - width - MARGIN);
  const bottom = Math.max(top, box.y + box.height - height - MARGIN);
  const clamp = ({ x, y }: Point) => ({ x: Math.min(right, Math.max(left, x)), y: Math.min(bottom, Math.max(top, y)) });
  const xs = [to.x - width - GAP, to.x + GAP, to.x - width / 2];
  const ys = [to.y - height - GAP, to.y + GAP, to.y - height / 2];
  const near = xs.flatMap((x) => ys.map((y) => clamp({ x, y })));
  const corners = [left, right].flatMap((x) => [top, bottom].map((y) => ({ x, y })));
  const cost = ({ x, y }: Point) => {
    const place = { x, y, width, height };
    const crossed = crosses(from, to, { x: x - 3, y: y - 3, width: width + 6, height: height + 6 });
    const away = Math.hypot(x + width / 2 - to.x, y + height / 2 - to.y);
    return (
      (crossed ? 1e6 : 0) + 1e4 * others.filter((o) => overlaps(place, o, 4)).length + 40 * occupied.count(place) + away
    );
  };
  return [...near, ...corners].reduce((best, place) => (cost(place) < cost(best) ? place : best));
}

/** Whether a line from a to b touches a box. */
export function crosses(a: Point, b: Point, { x, y, width, height }: Box): boolean {
  let [enter, leave] = [0, 1];
  for (const [start, delta, low, high] of [
    [a.x, b.x - a.x, x, x + width],
    [a.y, b.y - a.y, y, y + height],
  ] as const) {
    if (delta === 0) {
      if (start < low || start > high) return false;
      continue;
    }
    const [near, far] = [(low - start) / delta, (high - start) / delta];
    enter = Math.max(enter, Math.min(near, far));
    leave = Math.min(leave, Math.max(near, far));
  }
  return enter <= leave;
}
