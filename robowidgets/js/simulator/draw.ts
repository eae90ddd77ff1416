import { write } from "../shared/canvas.ts";
import { toShortMetres } from "../shared/format.ts";
import type { Theme } from "../shared/theme.ts";
import { ticks } from "../shared/ticks.ts";
import {
  endsOf,
  handleOf,
  type Place,
  type Projection,
  robotRadius,
  type Scene,
  type Thing,
  toPixel,
} from "./scene.ts";

type Context = CanvasRenderingContext2D;

const WALL = 3;
const DOT = 2.5;
/** Seconds after which a path has faded. */
const FADED = 30;
/** Metres between two places of a path beyond which the robot was put elsewhere. */
const JUMP = 1;
const TURN = 2 * Math.PI;

/** The floor, and below it the scale. */
export function drawFloor(context: Context, projection: Projection, theme: Theme): void {
  const { scale, bounds } = projection;
  const [from, to] = [
    toPixel(projection, { x: bounds.west, y: bounds.north }),
    toPixel(projection, { x: bounds.east, y: bounds.south }),
  ];
  context.fillStyle = theme.area;
  context.fillRect(from.x, from.y, to.x - from.x, to.y - from.y);
  const length = ticks(0, (bounds.east - bounds.west) / 2, 2)[1] ?? 1;
  const y = to.y + 15;
  context.strokeStyle = theme.muted;
  context.lineWidth = 1;
  context.beginPath();
  for (const x of [to.x - length * scale, to.x - 0.5]) {
    context.moveTo(x, y - 3);
    context.lineTo(x, y + 3);
  }
  context.moveTo(to.x - length * scale, y);
  context.lineTo(to.x - 0.5, y);
  context.stroke();
  write(context, toShortMetres(length), to.x - length * scale - 6, y, theme.muted, `11px ${theme.font}`, "right");
}

/** What the scanner has seen to be free. */
export function drawFree(context: Context, projection: Projection, { scan }: Scene, theme: Theme): void {
  const from = toPixel(projection, scan);
  const { bounds, left, top, scale } = projection;
  context.save();
  context.beginPath();
  context.rect(left, top, (bounds.east - bounds.west) * scale, (bounds.north - bounds.south) * scale);
  context.clip();
  context.beginPath();
  context.moveTo(from.x, from.y);
  for (const end of endsOf(scan)) {
    const { x, y } = end ? toPixel(projection, end) : from;
    context.lineTo(x, y);
  }
  context.fillStyle = theme.seen;
  context.fill();
  context.restore();
}

export function drawWalls(context: Context, projection: Projection, walls: Float32Array, theme: Theme): void {
  context.beginPath();
  for (let i = 0; i < walls.length; i += 4) {
    const [x1, y1, x2, y2] = walls.subarray(i, i + 4) as unknown as [number, number, number, number];
    const [from, to] = [toPixel(projection, { x: x1, y: y1 }), toPixel(projection, { x: x2, y: y2 })];
    context.moveTo(from.x, from.y);
    context.lineTo(to.x, to.y);
  }
  context.strokeStyle = theme.guide;
  context.lineWidth = WALL;
  context.lineCap = "square";
  context.stroke();
}

/** Obstacles, path, readings and the robot, and a ring round the thing that keys and buttons act on. */
export function drawThings(
  context: Context,
  projection: Projection,
  scene: Scene,
  selected: Thing | null,
  moved: Thing | null,
  theme: Theme,
): void {
  context.lineCap = "butt";
  for (const [i, disc] of scene.obstacles.entries()) {
    circle(context, toPixel(projection, disc), disc.radius * projection.scale);
    context.fillStyle = theme.line;
    context.fill();
    context.strokeStyle = moved === i ? theme.pointer : theme.guide;
    context.lineWidth = 1.25;
    context.stroke();
    if (selected === i) ring(context, toPixel(projection, disc), disc.radius * projection.scale, theme);
  }
  drawPath(context, projection, scene, theme);
  context.fillStyle = theme.reading;
  const { ranges } = scene.scan;
  for (const [i, end] of endsOf(scene.scan).entries()) {
    if (!end || !Number.isFinite(ranges[i])) continue;
    const { x, y } = toPixel(projection, end);
    context.fillRect(x - DOT / 2, y - DOT / 2, DOT, DOT);
  }
  drawRobot(context, projection, scene, moved !== null && typeof moved !== "number", theme);
  if (selected === "robot")
    ring(context, toPixel(projection, scene.robot), robotRadius(projection, scene.robot), theme);
}

function drawPath(context: Context, projection: Projection, { path, robot, time }: Scene, theme: Theme): void {
  context.strokeStyle = theme.ink;
  context.lineWidth = 1.75;
  const places = [...path, { ...robot, time }];
  for (const [i, to] of places.entries()) {
    const from = places[i - 1];
    if (!from || Math.hypot(to.x - from.x, to.y - from.y) > JUMP) continue;
    const [a, b] = [toPixel(projection, from), toPixel(projection, to)];
    context.globalAlpha = Math.max(0, 0.75 * (1 - (time - from.time) / FADED));
    context.beginPath();
    context.moveTo(a.x, a.y);
    context.lineTo(b.x, b.y);
    context.stroke();
  }
  context.globalAlpha = 1;
}

/** A disc with its nose inside, and the handle that turns it. */
function drawRobot(context: Context, projection: Projection, { robot }: Scene, isMoved: boolean, theme: Theme): void {
  const [at, radius] = [toPixel(projection, robot), robotRadius(projection, robot)];
  const handle = handleOf(projection, robot);
  const toward = { x: Math.cos(robot.yaw), y: -Math.sin(robot.yaw) };
  context.strokeStyle = isMoved ? theme.pointer : theme.muted;
  context.lineWidth = 1.25;
  context.beginPath();
  context.moveTo(at.x + toward.x * radius, at.y + toward.y * radius);
  context.lineTo(handle.x - toward.x * 3, handle.y - toward.y * 3);
  context.stroke();
  circle(context, handle, 3);
  context.fillStyle = theme.background;
  context.fill();
  context.stroke();
  circle(context, at, radius);
  context.fillStyle = isMoved ? theme.pointer : theme.ink;
  context.fill();
  context.strokeStyle = context.fillStyle = theme.background;
  context.lineWidth = 1.5;
  context.stroke();
  const nose = (angle: number, share: number): [number, number] => [
    at.x + share * radius * Math.cos(robot.yaw + angle),
    at.y - share * radius * Math.sin(robot.yaw + angle),
  ];
  context.beginPath();
  context.moveTo(...nose(0, 0.7));
  context.lineTo(...nose(2.4, 0.6));
  context.lineTo(...nose(Math.PI, 0.2));
  context.lineTo(...nose(-2.4, 0.6));
  context.closePath();
  context.fill();
}

function ring(context: Context, at: Place, radius: number, theme: Theme): void {
  circle(context, at, radius + 3.5);
  context.strokeStyle = theme.pointer;
  context.lineWidth = 1.75;
  context.stroke();
}

function circle(context: Context, { x, y }: Place, radius: number): void {
  context.beginPath();
  context.arc(x, y, radius, 0, TURN);
}
