import { type Context, circle, fill, line, stroke, write } from "../shared/canvas.ts";
import { clipToFloor, drawBody, type Place, type Projection, toPixel } from "../shared/floor.ts";
import { type Theme, textFont } from "../shared/theme.ts";
import { endsOf, handleOf, robotRadius, type Scene, type Thing } from "./scene.ts";

const WALL = 3;
const DOT = 2.5;
/** Pixels between the lines over a drop, and of the smallest one that has its name. */
const [HATCH, NAMED] = [10, 34];
/** Seconds after which a path has faded. */
const FADED = 30;
/** Metres between two places of a path beyond which the robot was moved by hand. */
const JUMP = 1;

/** The space that the scanner has seen to be free. */
export function drawFree(context: Context, projection: Projection, { scan }: Scene, theme: Theme): void {
  const from = toPixel(projection, scan);
  clipToFloor(context, projection, () => {
    context.beginPath();
    context.moveTo(from.x, from.y);
    for (const end of endsOf(scan)) {
      const { x, y } = end ? toPixel(projection, end) : from;
      context.lineTo(x, y);
    }
    fill(context, theme.seen);
  });
}

/** Places without floor: hatched, with their name if there is room. */
export function drawDrops(context: Context, projection: Projection, drops: Float32Array, theme: Theme): void {
  const boxes = Array.from({ length: drops.length / 4 }, (_, i) => {
    const [x1, y1, x2, y2] = drops.subarray(4 * i, 4 * i + 4) as unknown as [number, number, number, number];
    const [from, to] = [toPixel(projection, { x: x1, y: y1 }), toPixel(projection, { x: x2, y: y2 })];
    return [Math.min(from.x, to.x), Math.min(from.y, to.y), Math.abs(to.x - from.x), Math.abs(to.y - from.y)] as const;
  });
  context.save();
  context.beginPath();
  for (const box of boxes) context.rect(...box);
  stroke(context, theme.guide, 3);
  fill(context, theme.line);
  context.clip();
  context.beginPath();
  for (const [left, top, width, height] of boxes) {
    const first = Math.floor((left - top - height) / HATCH) * HATCH;
    for (let x = first; x < left + width - top; x += HATCH) {
      line(context, { x: x + top, y: top }, { x: x + top + height, y: top + height });
    }
  }
  stroke(context, theme.guide, 1);
  context.restore();
  for (const [left, top, width, height] of boxes) {
    if (Math.min(width, height) < NAMED) continue;
    write(context, "drop", left + width / 2, top + height / 2, theme.ink, textFont(theme), "center", theme.line);
  }
}

export function drawWalls(context: Context, projection: Projection, walls: Float32Array, theme: Theme): void {
  context.beginPath();
  for (let i = 0; i < walls.length; i += 4) {
    const [x1, y1, x2, y2] = walls.subarray(i, i + 4) as unknown as [number, number, number, number];
    line(context, toPixel(projection, { x: x1, y: y1 }), toPixel(projection, { x: x2, y: y2 }));
  }
  context.lineCap = "square";
  stroke(context, theme.guide, WALL);
  context.lineCap = "butt";
}

/** Obstacles, path and readings, and a ring round the obstacle that keys and buttons act on. */
export function drawThings(
  context: Context,
  projection: Projection,
  scene: Scene,
  selected: Thing | null,
  moved: Thing | null,
  theme: Theme,
): void {
  for (const [i, disc] of scene.obstacles.entries()) {
    const [at, radius] = [toPixel(projection, disc), disc.radius * projection.scale];
    circle(context, at, radius);
    fill(context, theme.line);
    stroke(context, moved === i ? theme.pointer : theme.guide, 1.25);
    if (selected === i) ring(context, at, radius, theme);
  }
  drawPath(context, projection, scene, theme);
  context.fillStyle = theme.reading;
  const { ranges } = scene.scan;
  for (const [i, end] of endsOf(scene.scan).entries()) {
    if (!end || !Number.isFinite(ranges[i])) continue;
    const { x, y } = toPixel(projection, end);
    context.fillRect(x - DOT / 2, y - DOT / 2, DOT, DOT);
  }
}

function drawPath(context: Context, projection: Projection, { path, robot, time }: Scene, theme: Theme): void {
  const places = [...path, { ...robot, time }];
  for (const [i, to] of places.entries()) {
    const from = places[i - 1];
    if (!from || Math.hypot(to.x - from.x, to.y - from.y) > JUMP) continue;
    context.globalAlpha = Math.max(0, 0.75 * (1 - (time - from.time) / FADED));
    context.beginPath();
    line(context, toPixel(projection, from), toPixel(projection, to));
    stroke(context, theme.ink, 1.75);
  }
  context.globalAlpha = 1;
}

/** A disc with its nose inside, the handle that turns it, and a ring round it while keys and buttons act on it. */
export function drawRobot(
  context: Context,
  projection: Projection,
  { robot }: Scene,
  selected: Thing | null,
  moved: Thing | null,
  theme: Theme,
): void {
  const [at, radius] = [toPixel(projection, robot), robotRadius(projection, robot)];
  const isMoved = moved !== null && typeof moved !== "number";
  const handle = handleOf(projection, robot);
  const toward = (distance: number, from = at): Place => ({
    x: from.x + distance * Math.cos(robot.yaw),
    y: from.y - distance * Math.sin(robot.yaw),
  });
  const outline = isMoved ? theme.pointer : theme.muted;
  context.beginPath();
  line(context, toward(radius), toward(-3, handle));
  stroke(context, outline, 1.25);
  circle(context, handle, 3);
  fill(context, theme.background);
  stroke(context, outline, 1.25);
  drawBody(context, at, robot.yaw, radius, isMoved ? theme.pointer : theme.ink, theme);
  if (selected === "robot") ring(context, at, radius, theme);
}

function ring(context: Context, at: Place, radius: number, theme: Theme): void {
  circle(context, at, radius + 3.5);
  stroke(context, theme.pointer, 1.75);
}
