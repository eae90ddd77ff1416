import type { Box, Point } from "../shared/box.ts";
import type { Cloud, Column } from "./cloud.ts";
import type { ViewName } from "./traits.ts";

/** An axis of the frame, and its sign: -1 if it grows to the left, down, or away from the viewer. */
export interface Axis {
  name: "x" | "y" | "z";
  sign: 1 | -1;
}

/** The axes that point right in the picture, up in it, and towards the viewer. */
export interface Axes {
  right: Axis;
  up: Axis;
  near: Axis;
}

const axis = (name: Axis["name"], sign: Axis["sign"]): Axis => ({ name, sign });

/** By REP-103: from above, x is up and y to the left; from the right side, x is to the right; from behind, y to the left. */
export const AXES: Record<Exclude<ViewName, "rows">, Axes> = {
  above: { right: axis("y", -1), up: axis("x", 1), near: axis("z", 1) },
  side: { right: axis("x", 1), up: axis("z", 1), near: axis("y", -1) },
  behind: { right: axis("y", -1), up: axis("z", 1), near: axis("x", -1) },
};

/** Places in the picture, in metres to the right and up. */
export interface Look {
  right: number;
  up: number;
  /** Metres from the middle to the nearer edge. */
  range: number;
}

/** Maps metres to pixels of the picture. */
export interface Projection {
  axes: Axes;
  /** Of the picture, without its scales. */
  box: Box;
  look: Look;
  /** Pixels per metre. */
  scale: number;
}

export function project(axes: Axes, box: Box, look: Look): Projection {
  return { axes, box, look, scale: Math.min(box.width, box.height) / 2 / look.range };
}

export function toPixel({ box, look, scale }: Projection, right: number, up: number): Point {
  return {
    x: box.x + box.width / 2 + (right - look.right) * scale,
    y: box.y + box.height / 2 - (up - look.up) * scale,
  };
}

/** Metres to the right and up. */
export function toMetres({ box, look, scale }: Projection, { x, y }: Point): [right: number, up: number] {
  return [look.right + (x - box.x - box.width / 2) / scale, look.up - (y - box.y - box.height / 2) / scale];
}

/** The value of an axis of the frame at some metres to the right, or up. */
export function along({ sign }: Axis, metres: number): number {
  return sign * metres;
}

export function columnsOf(cloud: Cloud, { right, up, near }: Axes): [Column, Column, Column] {
  return [cloud[right.name], cloud[up.name], cloud[near.name]];
}

/** Pixels of the scales at the left of the picture and below it. */
export const [LEFT, BELOW] = [38, 20];

/** A look at all points that were measured, and at the origin; ranges are round enough that they hold for a while. */
export function fitTo(cloud: Cloud, axes: Axes, box: Box): Look {
  const [rights, ups] = columnsOf(cloud, axes);
  let [west, east, south, north] = [0, 0, 0, 0];
  for (let i = 0; i < cloud.count; i++) {
    if (Number.isNaN(cloud.distance[i])) continue;
    const [right, up] = [axes.right.sign * (rights[i] as number), axes.up.sign * (ups[i] as number)];
    if (right < west) west = right;
    else if (right > east) east = right;
    if (up < south) south = up;
    else if (up > north) north = up;
  }
  const shorter = Math.min(box.width, box.height);
  const range = 0.53 * Math.max(((east - west) * shorter) / box.width, ((north - south) * shorter) / box.height);
  return { right: (west + east) / 2, up: (south + north) / 2, range: range || 1 };
}

/** The look of live clouds: it widens at once, and narrows only if it is far too wide, so that pictures stand still. */
export function steadied(before: Look | null, fitted: Look): Look {
  if (!before) return fitted;
  const shift = Math.hypot(before.right - fitted.right, before.up - fitted.up);
  const isWithin = fitted.range + shift <= before.range * 1.02;
  return isWithin && before.range < 1.6 * fitted.range ? before : { ...fitted, range: fitted.range * 1.08 };
}

const [CLOSEST, FARTHEST, STEP] = [0.01, 1e6, 1.25];

/** One step closer (-1) or farther away (+1), with a place of the picture staying where it is. */
export function zoomed(look: Look, direction: -1 | 1, [right, up]: [number, number] = [look.right, look.up]): Look {
  const range = Math.min(FARTHEST, Math.max(CLOSEST, look.range * STEP ** direction));
  const share = range / look.range;
  return { right: right + (look.right - right) * share, up: up + (look.up - up) * share, range };
}

export function canZoom({ range }: Look, direction: -1 | 1): boolean {
  return direction < 0 ? range > CLOSEST : range < FARTHEST;
}
