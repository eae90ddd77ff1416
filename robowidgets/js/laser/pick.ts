import type { Point } from "../shared/box.ts";
import { angleOf, indexAt, READING, type Scan } from "../shared/frames/scan.ts";
import { fromPixel, type Projection, toPixel } from "../shared/projection.ts";

const NEAR = 9;
const ROBOT = 8;
const BEYOND_RIM = 16;

/** A place in the picture. From the index view it has the ray there, which other rays may cover in the picture. */
export interface Place extends Point {
  index?: number;
}

/** Index of the ray under a place: the ray of the closest reading nearby, else the ray in that direction, or -1. */
export function pick(projection: Projection, scan: Scan, point: Place): number {
  if (point.index !== undefined) return point.index;
  const { range, angle } = fromPixel(projection, point);
  const scale = projection.radius / projection.viewRange;
  if (range * scale < ROBOT || range * scale > projection.radius + BEYOND_RIM) return -1;
  let found = -1;
  let least = NEAR;
  for (let i = 0; i < scan.count; i++) {
    const distance = scan.ranges[i] as number;
    if (scan.kinds[i] !== READING || Math.abs(distance - range) * scale > least) continue;
    const { x, y } = toPixel(projection, distance, angleOf(scan, i));
    const away = Math.hypot(x - point.x, y - point.y);
    if (away < least) {
      least = away;
      found = i;
    }
  }
  return found >= 0 ? found : indexAt(scan, angle);
}
