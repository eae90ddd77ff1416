import type { Point } from "../shared/box.ts";
import { type AngleUnit, decimalsFor, toAngle, toFixed, toMany, toMetres } from "../shared/format.ts";
import { angleOf, READING, type Scan } from "../shared/frames/scan.ts";
import { type Projection, toPixel } from "../shared/projection.ts";
import type { Metres } from "../shared/shapes/places.ts";
import type { Shape } from "../shared/traits.ts";
import type { ToShown } from "./mount.ts";

export function readingOf(scan: Scan | null, index: number): Metres | null {
  if (scan?.kinds[index] !== READING) return null;
  const [range, angle] = [scan.ranges[index] as number, angleOf(scan, index)];
  return [range * Math.cos(angle), range * Math.sin(angle)];
}

export function toPicture(projection: Projection, [x, y]: Metres): Point {
  return toPixel(projection, Math.hypot(x, y), Math.atan2(y, x));
}

/**
 * The numbers of a shape in words: distance and heading of a line, the number of points, the
 * radius of an arc, place and direction of a pose.
 *
 * @param reach metres of the picture, which set the decimals
 * @param toShown converts to the angle on show; places are shown in its frame, too
 */
export function describeShape(
  shape: Shape,
  places: Metres[],
  reach: number,
  unit: AngleUnit = "deg",
  toShown: ToShown = (angle) => angle,
): string {
  const [first, second] = places as [Metres, Metres];
  switch (shape.kind) {
    case "line":
      return places.length === 2
        ? `${toMetres(distanceTo(first, second), reach)} \u00B7 ${toAngle(headingOf(first, second, toShown), unit)}`
        : "";
    case "points":
      return places.length === 1 ? toMetres(Math.hypot(...first), reach) : toMany(places.length, "point");
    case "arc":
      return toMetres(shape.radius ?? 0, reach);
    case "arrow": {
      const [x, y] = turned(first, toShown).map((part) => toFixed(part, decimalsFor(reach)));
      return `x\u00A0${x} y\u00A0${y} \u00B7 ${toAngle(toShown(shape.yaw ?? 0), unit)}`;
    }
    default:
      return "";
  }
}

function turned([x, y]: Metres, toShown: ToShown): Metres {
  const [range, angle] = [Math.hypot(x, y), toShown(Math.atan2(y, x))];
  return [range * Math.cos(angle), range * Math.sin(angle)];
}

/** Metres from the scanner to the closest point of a line. */
function distanceTo([ax, ay]: Metres, [bx, by]: Metres): number {
  const [dx, dy] = [bx - ax, by - ay];
  const length = dx * dx + dy * dy;
  const along = length ? Math.min(1, Math.max(0, -(ax * dx + ay * dy) / length)) : 0;
  return Math.hypot(ax + along * dx, ay + along * dy);
}

/** The angle at which a line runs, within ±90 degrees: a wall has no direction. */
function headingOf([ax, ay]: Metres, [bx, by]: Metres, toShown: ToShown): number {
  const shown = toShown(Math.atan2(by - ay, bx - ax));
  const angle = Math.abs(shown) > Math.PI ? Math.atan2(Math.sin(shown), Math.cos(shown)) : shown;
  if (angle > Math.PI / 2) return angle - Math.PI;
  return angle <= -Math.PI / 2 ? angle + Math.PI : angle;
}

/** The shapes that still last some milliseconds after Python sent them. */
export function lasting(shapes: Shape[], ms: number): Shape[] {
  return shapes.filter(({ left = Infinity }) => 1000 * left > ms);
}

/** Milliseconds until the next of the shapes expires; infinite if all stay. */
export function untilNext(shapes: Shape[], ms: number): number {
  return Math.min(...lasting(shapes, ms).map(({ left = Infinity }) => 1000 * left - ms));
}
