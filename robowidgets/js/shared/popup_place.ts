import { type Box, overlaps, type Point, type Size } from "./box.ts";
import type { Occupancy } from "./occupancy.ts";

const GAP = 12;
const MARGIN = 4;

/**
 * Place of a pop-up: inside the box, near the ray that it names but not on it, and off readings and labels if possible.
 *
 * @param from the scanner's place, where the ray starts
 * @param to the reading, or the point at which the ray leaves the view
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
  const xs = steps(to.x, width, box.x, box.width);
  const ys = steps(to.y, height, box.y, box.height);
  const cost = ({ x, y }: Point) => {
    const place = { x, y, width, height };
    const crossed = crosses(from, to, { x: x - 3, y: y - 3, width: width + 6, height: height + 6 });
    const away = Math.hypot(x + width / 2 - to.x, y + height / 2 - to.y);
    return (
      (crossed ? 1e6 : 0) +
      1e4 * others.filter((other) => overlaps(place, other, 4)).length +
      100 * labels.filter((label) => overlaps(place, label)).length +
      60 * occupied.count(place) +
      away
    );
  };
  const places = xs.flatMap((x) => ys.map((y) => ({ x, y })));
  const costs = places.map(cost);
  return places[costs.indexOf(Math.min(...costs))] ?? to;
}

/**
 * Possible starts of a side of the pop-up: before, over and behind a point, and evenly from one end of the box to the
 * other.
 */
function steps(at: number, size: number, start: number, length: number): number[] {
  const first = start + MARGIN;
  const last = Math.max(first, start + length - size - MARGIN);
  const near = [-1.6, -1, -0.5, 0, 0.6].map((part) => at + part * size + GAP * Math.sign(part + 0.5));
  const even = [0, 1, 2, 3, 4, 5, 6, 7, 8].map((part) => first + (part / 8) * (last - first));
  return [...near.map((step) => Math.min(last, Math.max(first, step))), ...even];
}

/** Returns true if a line from a to b touches a box. */
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
