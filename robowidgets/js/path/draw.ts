import { type Context, circle, fill, line, stroke } from "../shared/canvas.ts";
import { drawBody, drawFloor, type Projection, scaleOf, toPixel } from "../shared/floor.ts";
import type { Theme } from "../shared/theme.ts";
import { isKnown, multiples, type Point, type TimedPose } from "./path.ts";

/** Radius of the robot in pixels: odometry does not contain its size. */
const ROBOT = 8;
/** Radius of the dot at the start of the path, and of the ring round the place of the pop-up. */
const [START, RING] = [3.5, 5.5];

/** The floor with a grid, whose lines are as far apart as the scale below shows. */
export function drawGrid(context: Context, projection: Projection, theme: Theme): void {
  drawFloor(context, projection, theme);
  const { west, east, south, north } = projection.bounds;
  const step = scaleOf(projection.bounds);
  context.beginPath();
  for (const x of multiples(step, west, east))
    line(context, toPixel(projection, { x, y: south }), toPixel(projection, { x, y: north }));
  for (const y of multiples(step, south, north))
    line(context, toPixel(projection, { x: west, y }), toPixel(projection, { x: east, y }));
  stroke(context, theme.line, 1);
}

/** The path so far, the rest, the robot, and a ring at the place of the pop-up. */
export function drawPath(
  context: Context,
  projection: Projection,
  { before, after }: { before: Point[]; after: Point[] },
  now: TimedPose,
  named: Point | null,
  theme: Theme,
): void {
  drawLine(context, projection, after, theme.guide, 1.5);
  drawLine(context, projection, before, theme.ink, 1.75);
  const start = before[0] ?? after[0];
  if (start) {
    circle(context, toPixel(projection, start), START);
    fill(context, theme.area);
    stroke(context, theme.ink, 1.25);
  }
  if (isKnown(now)) drawBody(context, toPixel(projection, now), now.yaw, ROBOT, theme.ink, theme);
  if (!named) return;
  circle(context, toPixel(projection, named), RING);
  stroke(context, theme.pointer, 2);
}

function drawLine(context: Context, projection: Projection, points: Point[], color: string, width: number): void {
  context.beginPath();
  for (const point of points) {
    const { x, y } = toPixel(projection, point);
    if (point.isAfterJump) context.moveTo(x, y);
    else context.lineTo(x, y);
  }
  context.lineJoin = "round";
  stroke(context, color, width);
}
