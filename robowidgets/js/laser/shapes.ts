import type { Point } from "../shared/box.ts";
import { type AngleUnit, decimalsFor, toAngle, toFixed, toMany, toMetres } from "../shared/format.ts";
import type { Shape, Spot } from "../shared/traits.ts";
import { type Projection, toPixel } from "./projection.ts";
import { angleOf, READING, type Scan } from "./scan.ts";

/** A place in metres in the frame of the scanner: x forward, y to the left. */
export type Metres = [x: number, y: number];

const TURN = 2 * Math.PI;
/** Radians of an arc that one straight piece of its picture spans. */
const PIECE = Math.PI / 90;

/** The places of a shape in metres; null when one is a ray without a reading. */
export function placesOf(at: Spot[], readingOf: (index: number) => Metres | null): Metres[] | null {
  const places = at.map((spot) => (typeof spot === "number" ? readingOf(spot) : spot));
  return places.every((place) => place !== null) ? places : null;
}

export function readingOf(scan: Scan | null, index: number): Metres | null {
  if (scan?.kinds[index] !== READING) return null;
  const [range, angle] = [scan.ranges[index] as number, angleOf(scan, index)];
  return [range * Math.cos(angle), range * Math.sin(angle)];
}

export function toPicture(projection: Projection, [x, y]: Metres): Point {
  return toPixel(projection, Math.hypot(x, y), Math.atan2(y, x));
}

/** The places along an arc, from its first angle counter-clockwise to its second. */
export function arcPlaces({ start = 0, end = TURN, radius = 0 }: Shape, [x, y]: Metres): Metres[] {
  const turned = end - start >= TURN ? TURN : (((end - start) % TURN) + TURN) % TURN;
  const pieces = Math.max(1, Math.ceil(turned / PIECE));
  return Array.from({ length: pieces + 1 }, (_, i) => {
    const angle = start + (turned * i) / pieces;
    return [x + radius * Math.cos(angle), y + radius * Math.sin(angle)];
  });
}

/** Whether an arc is a whole circle, which has no ends. */
export function isCircle({ start = 0, end = TURN }: Shape): boolean {
  return end - start >= TURN - 1e-9;
}

/**
 * The numbers of a shape in words: of a line how far it is from the scanner and how it runs, of points how many, of an
 * arc its radius, of a pose its place and direction.
 *
 * @param reach metres of the picture, which set the decimals
 */
export function describeShape(shape: Shape, places: Metres[], reach: number, unit: AngleUnit = "deg"): string {
  const [first, second] = places as [Metres, Metres];
  switch (shape.kind) {
    case "line":
      return places.length === 2
        ? `${toMetres(distanceTo(first, second), reach)} \u00B7 ${toAngle(headingOf(first, second), unit)}`
        : "";
    case "points":
      return places.length === 1 ? toMetres(Math.hypot(...first), reach) : toMany(places.length, "point");
    case "arc":
      return toMetres(shape.radius ?? 0, reach);
    case "pose": {
      const [x, y] = first.map((part) => toFixed(part, decimalsFor(reach)));
      return `x\u00A0${x} y\u00A0${y} \u00B7 ${toAngle(shape.yaw ?? 0, unit)}`;
    }
    default:
      return "";
  }
}

/** Metres from the scanner to the closest point of a line. */
function distanceTo([ax, ay]: Metres, [bx, by]: Metres): number {
  const [dx, dy] = [bx - ax, by - ay];
  const length = dx * dx + dy * dy;
  const along = length ? Math.min(1, Math.max(0, -(ax * dx + ay * dy) / length)) : 0;
  return Math.hypot(ax + along * dx, ay + along * dy);
}

/** The angle at which a line runs, within ±90 degrees: a wall has no direction. */
function headingOf([ax, ay]: Metres, [bx, by]: Metres): number {
  const angle = Math.atan2(by - ay, bx - ax);
  if (angle > Math.PI / 2) return angle - Math.PI;
  return angle <= -Math.PI / 2 ? angle + Math.PI : angle;
}

/** The shapes that are there some milliseconds after Python sent them. */
export function lasting(shapes: Shape[], ms: number): Shape[] {
  return shapes.filter(({ left = Infinity }) => 1000 * left > ms);
}

/** Milliseconds until the next of the shapes goes; infinite when all stay. */
export function untilNext(shapes: Shape[], ms: number): number {
  return Math.min(...lasting(shapes, ms).map(({ left = Infinity }) => 1000 * left - ms));
}
