import type { Box, Point } from "../shared/box.ts";
import { GAP, heightOf } from "./rows.ts";

/** The place of a sensor on the body, and the line from there to its rectangle. */
export interface Lead {
  name: string;
  angle: number;
  from: Point;
  to: Point;
}

export interface Around {
  center: Point;
  radius: number;
  boxes: Map<string, Box>;
  leads: Lead[];
  height: number;
}

/** Least width in pixels for words in the rectangles at the sides. */
export const LEAST_WIDTH = 220;
const WIDEST = 190;
const SIDES = Math.sin((20 * Math.PI) / 180);

/**
 * Lays rectangles around the robot's body, forward up: sensors ahead above it, sensors behind below it, the others in a
 * column at their side. Rectangles never overlap; a line leads from each to the place of its sensor.
 *
 * @param angles sensor name to radians counter-clockwise from forward
 */
export function layAround(angles: Map<string, number>, width: number): Around {
  const radius = Math.min(62, Math.max(28, width * 0.1));
  const lead = Math.min(22, Math.max(12, width * 0.03));
  const tile = Math.min(WIDEST, (width - 2 * radius - 2 * lead) / 2);
  const high = heightOf(tile);
  const sorted = [...angles].map(([name, angle]) => ({ name, angle: wrap(angle) }));
  const isAcross = (angle: number) => Math.abs(Math.sin(angle)) < SIDES;
  const ahead = sorted.filter(({ angle }) => isAcross(angle) && Math.cos(angle) > 0);
  const behind = sorted.filter(({ angle }) => isAcross(angle) && Math.cos(angle) < 0);
  const left = sorted.filter(({ angle }) => !isAcross(angle) && angle > 0);
  const right = sorted.filter(({ angle }) => !isAcross(angle) && angle < 0);
  ahead.sort((a, b) => b.angle - a.angle);
  behind.sort((a, b) => unwrap(a.angle) - unwrap(b.angle));
  left.sort((a, b) => a.angle - b.angle);
  right.sort((a, b) => b.angle - a.angle);

  const perRow = Math.max(1, Math.floor((width + GAP) / (tile + GAP)));
  const above = Math.ceil(ahead.length / perRow) * (high + GAP);
  const sides = Math.max(left.length, right.length) * (high + GAP) - GAP;
  const middle = Math.max(2 * radius, sides);
  const top = above && above - GAP + lead;
  const center = { x: width / 2, y: top + middle / 2 };
  const boxes = new Map<string, Box>();

  const inRows = (names: string[], y: number) =>
    names.forEach((name, i) => {
      const row = Math.floor(i / perRow);
      const inRow = Math.min(perRow, names.length - row * perRow);
      const x = center.x - (inRow * (tile + GAP) - GAP) / 2 + (i % perRow) * (tile + GAP);
      boxes.set(name, { x, y: y + row * (high + GAP), width: tile, height: high });
    });
  const inColumn = (column: { name: string; angle: number }[], x: number) => {
    const wanted = column.map(({ angle }) => center.y - radius * Math.cos(angle) - high / 2);
    const tops = spread(wanted, high + GAP, center.y - middle / 2, center.y + middle / 2 - high);
    column.forEach(({ name }, i) => {
      boxes.set(name, { x, y: tops[i] ?? 0, width: tile, height: high });
    });
  };
  inRows(namesOf(ahead), 0);
  inColumn(left, center.x - radius - lead - tile);
  inColumn(right, center.x + radius + lead);
  const below = center.y + middle / 2 + lead;
  inRows(namesOf(behind), below);
  const height = behind.length ? below + Math.ceil(behind.length / perRow) * (high + GAP) - GAP : center.y + middle / 2;

  const leads = sorted.flatMap(({ name, angle }) => {
    const box = boxes.get(name);
    if (!box) return [];
    const from = { x: center.x - radius * Math.sin(angle), y: center.y - radius * Math.cos(angle) };
    return [{ name, angle, from, to: edgeOf(box, from, isAcross(angle)) }];
  });
  return { center, radius, boxes, leads, height };
}

/** Positions as close to the wanted ones as a distance between them and both ends allow; in the given order. */
export function spread(wanted: number[], distance: number, first: number, last: number): number[] {
  const placed: number[] = [];
  for (const want of wanted) {
    const previous = placed.at(-1);
    placed.push(Math.max(want, first, previous === undefined ? first : previous + distance));
  }
  let limit = last;
  for (let i = placed.length - 1; i >= 0; i -= 1) {
    placed[i] = Math.min(placed[i] as number, limit);
    limit = (placed[i] as number) - distance;
  }
  return placed;
}

/** The middle of the edge of a box that faces the body. */
function edgeOf({ x, y, width, height }: Box, from: Point, across: boolean): Point {
  if (across) return { x: Math.min(Math.max(from.x, x + 8), x + width - 8), y: y < from.y ? y + height : y };
  return { x: x < from.x ? x + width : x, y: y + height / 2 };
}

function namesOf(sensors: { name: string }[]): string[] {
  return sensors.map(({ name }) => name);
}

/** An angle within -pi and pi. */
function wrap(angle: number): number {
  return Math.atan2(Math.sin(angle), Math.cos(angle));
}

/** An angle within 0 and 2 pi, for sensors behind. */
function unwrap(angle: number): number {
  return angle < 0 ? angle + 2 * Math.PI : angle;
}
