import type { Point } from "../box.ts";
import type { Theme } from "../theme.ts";
import type { Shape } from "../traits.ts";
import { arcPlaces, isCircle, type Metres } from "./places.ts";

/** Of the lines, in pixels. */
export const WIDTH = 2;
/** Half the length of the tick at the end of a line, in pixels. */
const TICK = 5;
const RING = 3.5;
/** Pixels from the middle of a pose to the tip of its arrow. */
const ARROW = 22;
const HEAD = 7;
/** Pixels between the places of a path. */
const STEP = 4;
/** Greatest number of pieces of a path whose larger part lies outside of the view. */
const MOST_PIECES = 2000;

/** Maps a place to the picture. */
type ToPoint = (place: Metres) => Point;

/** Draws a shape without its words, which are labels of the picture. */
export function drawShape(
  context: CanvasRenderingContext2D,
  toPoint: ToPoint,
  shape: Shape,
  places: Metres[],
  theme: Theme,
): void {
  const points = outlineOf(toPoint, shape, places);
  context.strokeStyle = context.fillStyle = shape.color ?? theme.own;
  context.lineWidth = WIDTH;
  context.lineJoin = "round";
  context.beginPath();
  if (shape.kind === "points") {
    for (const { x, y } of points) {
      context.moveTo(x + RING, y);
      context.arc(x, y, RING, 0, 2 * Math.PI);
    }
  } else if (shape.kind === "arrow") {
    traceArrow(context, points[0] as Point, directionOf(toPoint, shape, places));
  } else if (shape.kind !== "text") {
    for (const [i, { x, y }] of points.entries()) {
      if (i) context.lineTo(x, y);
      else context.moveTo(x, y);
    }
    if (shape.kind === "polygon") context.closePath();
    else if (shape.kind === "line" || !isCircle(shape)) {
      traceTick(context, points[0] as Point, points[1] as Point);
      traceTick(context, points.at(-1) as Point, points.at(-2) as Point);
    }
  }
  context.stroke();
}

/** A short line across the end of another. */
function traceTick(context: CanvasRenderingContext2D, end: Point, before: Point): void {
  const [dx, dy] = [end.x - before.x, end.y - before.y];
  const length = Math.hypot(dx, dy) || 1;
  const [x, y] = [(-dy / length) * TICK, (dx / length) * TICK];
  context.moveTo(end.x - x, end.y - y);
  context.lineTo(end.x + x, end.y + y);
}

function traceArrow(context: CanvasRenderingContext2D, place: Point, angle: number): void {
  const [edge, tip] = [tipOf(place, angle, 2 * RING), tipOf(place, angle)];
  context.moveTo(place.x + 2 * RING, place.y);
  context.arc(place.x, place.y, 2 * RING, 0, 2 * Math.PI);
  context.moveTo(edge.x, edge.y);
  context.lineTo(tip.x, tip.y);
  for (const turn of [2.6, -2.6]) {
    const end = tipOf(tip, angle + turn, HEAD);
    context.moveTo(tip.x, tip.y);
    context.lineTo(end.x, end.y);
  }
}

/** The point so many pixels from another in a direction of the picture. */
function tipOf({ x, y }: Point, angle: number, length = ARROW): Point {
  return { x: x + length * Math.cos(angle), y: y - length * Math.sin(angle) };
}

/** The direction of an arrow in the picture. */
function directionOf(toPoint: ToPoint, { yaw = 0 }: Shape, [place]: Metres[]): number {
  const [x, y] = place as Metres;
  const [from, to] = [toPoint([x, y]), toPoint([x + Math.cos(yaw), y + Math.sin(yaw)])];
  return Math.atan2(from.y - to.y, to.x - from.x);
}

/** The corners of a shape in the picture. */
function outlineOf(toPoint: ToPoint, shape: Shape, places: Metres[]): Point[] {
  const corners = shape.kind === "arc" ? arcPlaces(shape, places[0] as Metres) : places;
  return corners.map(toPoint);
}

/** Points of the picture along a shape, a few pixels apart, within the view. */
export function pathOf(toPoint: ToPoint, isInView: (point: Point) => boolean, shape: Shape, places: Metres[]): Point[] {
  const points = outlineOf(toPoint, shape, places);
  if (shape.kind === "points" || shape.kind === "text") return points.filter(isInView);
  const closed = shape.kind === "polygon" ? [...points, points[0] as Point] : points;
  if (shape.kind === "arrow") closed.push(tipOf(points[0] as Point, directionOf(toPoint, shape, places)));
  const path: Point[] = [];
  for (const [i, from] of closed.slice(0, -1).entries()) {
    const to = closed[i + 1] as Point;
    const pieces = Math.min(MOST_PIECES, Math.max(1, Math.ceil(Math.hypot(to.x - from.x, to.y - from.y) / STEP)));
    for (let k = 0; k <= pieces; k++) {
      const share = k / pieces;
      path.push({ x: from.x + share * (to.x - from.x), y: from.y + share * (to.y - from.y) });
    }
  }
  if (shape.kind === "arrow")
    path.push(...[0, 1, 2, 3].map((i) => tipOf(points[0] as Point, i * (Math.PI / 2), 2 * RING)));
  return path.filter(isInView);
}
