import type { Point } from "../shared/box.ts";
import type { Mount } from "../shared/frames/ring.ts";

/** Maps metres to the picture: the robot's middle is in its centre, x points up, y to the left. */
export interface View {
  centerX: number;
  centerY: number;
  /** Pixels from there to the edge of the view. */
  radius: number;
  /** Metres from there to the edge of the view. */
  viewRange: number;
}

/** Pixels per metre. */
export function scaleOf({ radius, viewRange }: View): number {
  return radius / viewRange;
}

export function toPixel(view: View, { x, y }: Point): Point {
  const scale = scaleOf(view);
  return { x: view.centerX - y * scale, y: view.centerY - x * scale };
}

export function toFloor(view: View, { x, y }: Point): Point {
  const scale = scaleOf(view);
  return { x: (view.centerY - y) / scale, y: (view.centerX - x) / scale };
}

/** The point at a distance from a sensor, at an angle in radians from its axis; in metres of the robot's frame. */
export function toFloorPoint({ x, y, yaw }: Mount, distance: number, beside: number): Point {
  return { x: x + distance * Math.cos(yaw + beside), y: y + distance * Math.sin(yaw + beside) };
}
