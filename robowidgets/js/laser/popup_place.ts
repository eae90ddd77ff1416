import type { Size } from "../shared/canvas.ts";
import { type Occupancy, overlaps } from "./guides.ts";
import type { Box, Point } from "./projection.ts";

const GAP = 12;
const MARGIN = 4;

/**
 * Where a pop-up goes: in the box, off the ray it names, and near it; off readings, labels and pop-ups where it can.
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
  labels: Box[],
): Point {
  const { width, height } = size;
  const left = box.x + MARGIN;
  const top = box.y + MARGIN;
  const right = Math.max(left, box.x + box.width - width - MARGIN);
  const bottom = Math.max(top, box.y + box.height - height - MARGIN);
  const clamp = ({ x, y }: Point) => ({ x: Math.min(right, Math.max(left, x)), y: Math.min(bottom, Math.max(top, y)) });
  const xs = [to.x - width - GAP, to.x + GAP, to.x - width / 2];
  const ys = [to.y - height - GAP, to.y + GAP, to.y - height / 2];
  const near = xs.flatMap((x) => ys.map((y) => ({ x, y })));
  const shifts = [-1, 0, 1].flatMap((x) => [-1, 0, 1].map((y) => ({ x: x * width * 0.6, y: y * height * 0.8 })));
  const around = near.flatMap(({ x, y }) => shifts.map((shift) => clamp({ x: x + shift.x, y: y + shift.y })));
  const corners = [left, right].flatMap((x) => [top, bottom].map((y) => ({ x, y })));
  const cost = ({ x, y }: Point) => {
    const place = { x, y, width, height };
    const crossed = crosses(from, to, { x: x - 3, y: y - 3, width: width + 6, height: height + 6 });
    const away = Math.hypot(x + width / 2 - to.x, y + height / 2 - to.y);
    return (
      (crossed ? 1e6 : 0) +
      1e4 * others.filter((other) => overlaps(place, other, 4)).length +
      100 * labels.filter((label) => overlaps(place, label)).length +
      12 * occupied.count(place) +
      away
    );
  };
  return [...around, ...corners].reduce((best, place) => (cost(place) < cost(best) ? place : best));
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
