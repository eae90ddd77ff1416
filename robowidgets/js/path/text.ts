import { toDegrees, toFixed, toMetres } from "../shared/format.ts";
import type { PopupWords } from "../shared/popup.ts";
import type { Point, TimedPose } from "./path.ts";

/** "x 1.23 m, y \u22120.45 m" */
export function toPlace({ x, y }: TimedPose): string {
  return `x ${toMetres(x)}, y ${toMetres(y)}`;
}

export function toHeading({ yaw }: TimedPose): string {
  return Number.isNaN(yaw) ? "unknown" : toDegrees(yaw);
}

/** A place, with its heading if that is known. */
export function toPose(pose: TimedPose): string {
  return Number.isNaN(pose.yaw) ? toPlace(pose) : `${toPlace(pose)}, ${toHeading(pose)}`;
}

/** The texts of the pop-up of a place of the path: its time, also from the moment on show. */
export function describePoint(point: Point, now: TimedPose): PopupWords {
  const apart = point.time - now.time;
  const side = Math.abs(apart) < 0.005 ? "now" : `${toFixed(Math.abs(apart), 2)} s ${apart < 0 ? "before" : "later"}`;
  return {
    expression: `${toFixed(point.time, 2)} s`,
    distance: toPlace(point),
    details: `heading ${toHeading(point)}\ndriven ${toMetres(point.way)}`,
    angle: "",
    side,
  };
}
