import type { Point, Size } from "../shared/box.ts";

/** Least scale at which a picture is shown whole at first: smaller texts are unreadable. */
const READABLE = 0.75;
const [SMALLEST, LARGEST] = [0.2, 2.5];
const EDGE = 40;

/** The visible part of a picture: a scale, and the place of its left upper corner. */
export interface Sight extends Point {
  scale: number;
}

/** All of a picture in the middle of some room; if that would be too small to read, its left upper part. */
export function fitted(picture: Size, room: Size): Sight {
  const whole = Math.min(room.width / picture.width, room.height / picture.height, 1);
  const scale = Math.max(READABLE, Number.isFinite(whole) ? whole : 1);
  const middle = (size: number, of: number) => Math.max(0, (of - size * scale) / 2);
  return { scale, x: middle(picture.width, room.width), y: middle(picture.height, room.height) };
}

/** All of a picture, however small. */
export function whole(picture: Size, room: Size): Sight {
  const scale = Math.max(SMALLEST, Math.min(1, room.width / picture.width, room.height / picture.height));
  return { scale, x: (room.width - picture.width * scale) / 2, y: (room.height - picture.height * scale) / 2 };
}

/** Scaled about a point that stays at its place. */
export function scaled({ scale, x, y }: Sight, factor: number, at: Point): Sight {
  const next = Math.min(LARGEST, Math.max(SMALLEST, scale * factor));
  return { scale: next, x: at.x - ((at.x - x) * next) / scale, y: at.y - ((at.y - y) * next) / scale };
}

/** Moved by some pixels, but never so far that the whole picture is out of view. */
export function shifted({ scale, x, y }: Sight, by: Point, picture: Size, room: Size): Sight {
  const keep = (at: number, size: number, of: number) => Math.min(of - EDGE, Math.max(EDGE - size * scale, at));
  return { scale, x: keep(x + by.x, picture.width, room.width), y: keep(y + by.y, picture.height, room.height) };
}
