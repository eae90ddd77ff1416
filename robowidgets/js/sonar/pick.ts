import { holds, type Point } from "../shared/box.ts";
import type { Cone } from "./cones.ts";
import { scaleOf, toFloor, type View } from "./floor.ts";
import type { Label } from "./labels.ts";

/** Pixels round the robot's middle without a cone, and beyond the rim that still belong to one. */
const [ROBOT, BEYOND] = [6, 8];
/** Radians from the axis of a narrow beam that still belong to it. */
const LEAST = 0.14;

/** The index of the cone under a point of the picture, or of its label; null for none. */
export function pick(view: View, cones: Cone[], labels: Label[], point: Point): number | null {
  const labelled = labels.find(({ box }) => holds(box, point));
  if (labelled) return labelled.index;
  const away = Math.hypot(point.x - view.centerX, point.y - view.centerY);
  if (away < ROBOT || away > view.radius + BEYOND) return null;
  const floor = toFloor(view, point);
  let found: number | null = null;
  let least = Infinity;
  for (const { index, mount, view: opening } of cones) {
    const [dx, dy] = [floor.x - mount.x, floor.y - mount.y];
    const beside = Math.abs(wrap(Math.atan2(dy, dx) - mount.yaw));
    // Of two beams in the same direction, the closer axis, in pixels.
    const off = Math.hypot(dx, dy) * Math.sin(Math.min(beside, Math.PI / 2)) * scaleOf(view);
    if (beside <= Math.max(LEAST, opening / 2) && off < least) {
      least = off;
      found = index;
    }
  }
  return found;
}

function wrap(angle: number): number {
  return Math.atan2(Math.sin(angle), Math.cos(angle));
}
