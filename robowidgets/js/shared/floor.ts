import type { Box, Size } from "./box.ts";
import { type Context, circle, fill, line, stroke, write } from "./canvas.ts";
import { toShortMetres } from "./format.ts";
import { type Theme, textFont } from "./theme.ts";
import { ticks } from "./ticks.ts";

/** Corners of the nose: angle from forward, and share of the radius. */
const NOSE = [
  [0, 0.7],
  [2.4, 0.6],
  [Math.PI, 0.2],
  [-2.4, 0.6],
] as const;

/** A place in metres in the frame of the floor, unless pixels of the picture are mentioned. */
export interface Place {
  x: number;
  y: number;
}

/** A place with a heading, radians counter-clockwise from x. */
export interface Pose extends Place {
  yaw: number;
}

/** Metres from west to east and from south to north. */
export interface Bounds {
  west: number;
  east: number;
  south: number;
  north: number;
}

/** Pixels at the sides of the floor, and below it for the scale. */
export const MARGIN = 12;
export const BELOW = 28;

/** Maps metres to pixels of the picture. */
export interface Projection {
  /** Pixels per metre. */
  scale: number;
  left: number;
  top: number;
  bounds: Bounds;
}

/** The largest picture of the floor that fits, in the middle of a room that begins some pixels below the top. */
export function fit(bounds: Bounds, { width, height }: Size, top = 0): Projection {
  const [wide, high] = [bounds.east - bounds.west, bounds.north - bounds.south];
  const scale = Math.max(1e-6, Math.min((width - 2 * MARGIN) / wide, (height - MARGIN - BELOW) / high));
  return {
    scale,
    left: (width - wide * scale) / 2,
    top: top + MARGIN + (height - MARGIN - BELOW - high * scale) / 2,
    bounds,
  };
}

/** The floor in pixels. */
export function floorOf({ scale, left, top, bounds }: Projection): Box {
  const { west, east, north, south } = bounds;
  return { x: left, y: top, width: (east - west) * scale, height: (north - south) * scale };
}

export function toPixel({ scale, left, top, bounds }: Projection, { x, y }: Place): Place {
  return { x: left + (x - bounds.west) * scale, y: top + (bounds.north - y) * scale };
}

export function toFloor({ scale, left, top, bounds }: Projection, { x, y }: Place): Place {
  return { x: bounds.west + (x - left) / scale, y: bounds.north - (y - top) / scale };
}

/** Metres of the scale: a round number, less than half of the floor's width, and than its height. */
export function scaleOf({ west, east, south, north }: Bounds): number {
  return ticks(0, Math.min((east - west) / 2, north - south), 2)[1] ?? 1;
}

/** The floor, and below it the scale. */
export function drawFloor(context: Context, projection: Projection, theme: Theme): void {
  const { scale, bounds } = projection;
  const floor = floorOf(projection);
  context.fillStyle = theme.area;
  context.fillRect(floor.x, floor.y, floor.width, floor.height);
  const length = scaleOf(bounds);
  const [right, y] = [floor.x + floor.width, floor.y + floor.height + 15];
  const [west, east] = [right - length * scale, right - 0.5];
  context.beginPath();
  for (const x of [west, east]) line(context, { x, y: y - 3 }, { x, y: y + 3 });
  line(context, { x: west, y }, { x: east, y });
  stroke(context, theme.muted, 1);
  write(context, toShortMetres(length), west - 6, y, theme.muted, textFont(theme), "right");
}

/** Calls a function that draws on the floor only. */
export function clipToFloor(context: Context, projection: Projection, draw: () => void): void {
  const { x, y, width, height } = floorOf(projection);
  context.save();
  context.beginPath();
  context.rect(x, y, width, height);
  context.clip();
  draw();
  context.restore();
}

/** A robot as a disc with its nose inside, at a place in pixels. */
export function drawBody(context: Context, at: Place, yaw: number, radius: number, color: string, theme: Theme): void {
  circle(context, at, radius);
  fill(context, color);
  stroke(context, theme.background, 1.5);
  context.beginPath();
  for (const [angle, share] of NOSE) {
    context.lineTo(at.x + share * radius * Math.cos(yaw + angle), at.y - share * radius * Math.sin(yaw + angle));
  }
  fill(context, theme.background);
}
