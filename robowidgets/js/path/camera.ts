import type { Size } from "../shared/box.ts";
import { BELOW, type Bounds, MARGIN, type Place } from "../shared/floor.ts";

const [CLOSEST, FARTHEST] = [0.2, 1e6];
const STEP = 1.25;

/** The part of the floor on show after the user has zoomed or moved: its middle, and metres from side to side. */
export interface Look extends Place {
  width: number;
}

/** The floor in a picture of a size. */
export function boundsOfLook({ x, y, width }: Look, picture: Size): Bounds {
  const height = width / aspectOf(picture);
  return { west: x - width / 2, east: x + width / 2, south: y - height / 2, north: y + height / 2 };
}

function aspectOf({ width, height }: Size): number {
  return Math.max(1, width - 2 * MARGIN) / Math.max(1, height - MARGIN - BELOW);
}

/** The look at the part on show. */
export function lookOf({ west, east, south, north }: Bounds): Look {
  return { x: (west + east) / 2, y: (south + north) / 2, width: east - west };
}

/** One step closer (-1) or farther away (+1), with a place staying where it is. */
export function zoomed(look: Look, direction: -1 | 1, at: Place = look): Look {
  const width = Math.min(FARTHEST, Math.max(CLOSEST, look.width * STEP ** direction));
  const share = width / look.width;
  return { x: at.x + (look.x - at.x) * share, y: at.y + (look.y - at.y) * share, width };
}

export function canZoom({ width }: Look, direction: -1 | 1): boolean {
  return direction < 0 ? width > CLOSEST : width < FARTHEST;
}
