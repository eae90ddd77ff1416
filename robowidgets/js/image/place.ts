import type { Box, Point, Size } from "../shared/box.ts";

/** Pixels of the screen for one of the picture, at most. */
const CLOSEST = 64;
const STEP = 1.3;

/** The middle of the view, in pixels of the picture, and the number of pixels of the screen for each of them. */
export interface Look {
  column: number;
  row: number;
  scale: number;
}

/** The placement of a picture on the screen. */
export interface Placement {
  /** Pixels of the screen for one of the picture. */
  scale: number;
  /** The left upper corner of pixel [0, 0]. */
  left: number;
  top: number;
}

/** The largest scale at which all of the picture fits. */
export function fitScaleOf(picture: Size, room: Size): number {
  return Math.min(room.width / picture.width, room.height / picture.height);
}

/**
 * Places a picture in a box: all of it, or the look, moved so that the picture leaves no room empty that it could fill.
 */
export function placeIn(picture: Size, room: Box, look: Look | null): Placement {
  const fitted = fitScaleOf(picture, room);
  const scale = look ? Math.max(fitted, look.scale) : fitted;
  const along = (start: number, length: number, size: number, middle: number) => {
    const whole = size * scale;
    if (whole <= length) return start + (length - whole) / 2;
    return Math.min(start, Math.max(start + length - whole, start + length / 2 - middle * scale));
  };
  return {
    scale,
    left: along(room.x, room.width, picture.width, look?.column ?? 0),
    top: along(room.y, room.height, picture.height, look?.row ?? 0),
  };
}

/** The look at the middle of a box. */
export function lookAt({ scale, left, top }: Placement, room: Box): Look {
  return {
    scale,
    column: (room.x + room.width / 2 - left) / scale,
    row: (room.y + room.height / 2 - top) / scale,
  };
}

/**
 * Returns the look one step nearer (-1) or farther (+1), with a place of the screen staying where it is; null for all
 * of the picture.
 */
export function zoomed(placement: Placement, direction: -1 | 1, at: Point, picture: Size, room: Box): Look | null {
  const fitted = fitScaleOf(picture, room);
  const scale = Math.min(Math.max(CLOSEST, fitted), placement.scale * (direction < 0 ? STEP : 1 / STEP));
  if (scale <= fitted * 1.001) return null;
  const { column, row } = toPicture(placement, at);
  const [dx, dy] = [room.x + room.width / 2 - at.x, room.y + room.height / 2 - at.y];
  return { scale, column: column + dx / scale, row: row + dy / scale };
}

/** A place of the screen in pixels of the picture, whose corners are whole numbers. */
export function toPicture({ scale, left, top }: Placement, { x, y }: Point): { row: number; column: number } {
  return { row: (y - top) / scale, column: (x - left) / scale };
}

/** Pixels between a part of the picture and its pop-up. */
const GAP = 8;

/** The place at which a pop-up covers the least of a part of the picture, as near to it as possible. */
export function placeBeside({ width, height }: Size, room: Box, part: Box): Point {
  const along = (start: number, length: number, size: number, from: number, long: number) => {
    const [first, last] = [start + GAP, Math.max(start + GAP, start + length - size - GAP)];
    const near = [from - size - GAP, from, from + long - size, from + long + GAP];
    return [...near.map((at) => Math.min(last, Math.max(first, at))), first, last];
  };
  const xs = along(room.x, room.width, width, part.x, part.width);
  const ys = along(room.y, room.height, height, part.y, part.height);
  const shared = (a: number, long: number, b: number, other: number) =>
    Math.max(0, Math.min(a + long, b + other) - Math.max(a, b));
  const cost = ({ x, y }: Point) => {
    const covered = shared(x, width, part.x, part.width) * shared(y, height, part.y, part.height);
    const away = Math.hypot(x + width / 2 - part.x - part.width / 2, y + height / 2 - part.y - part.height / 2);
    return 1e3 * covered + away;
  };
  const places = xs.flatMap((x) => ys.map((y) => ({ x, y })));
  return places.reduce((best, place) => (cost(place) < cost(best) ? place : best));
}

/** The box of a part of the picture on the screen. */
export function boxOf({ scale, left, top }: Placement, [from, to, first, end]: readonly number[]): Box {
  const [row = 0, last = 0, column = 0, stop = 0] = [from, to, first, end];
  return {
    x: left + column * scale,
    y: top + row * scale,
    width: (stop - column) * scale,
    height: (last - row) * scale,
  };
}
