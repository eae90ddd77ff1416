import type { Size } from "../shared/canvas.ts";
import { angleOf, isFullCircle, type Sweep } from "./scan.ts";

export interface Point {
  x: number;
  y: number;
}

export interface Box extends Point, Size {}

/** Where the scanner stands in the picture, and how metres become pixels. */
export interface Projection {
  centerX: number;
  centerY: number;
  /** Pixels from the scanner to the edge of the view. */
  radius: number;
  /** Metres from the scanner to the edge of the view. */
  viewRange: number;
  /** Picture angle of the robot's forward, radians counter-clockwise from the right. */
  forward: number;
}

export const FORWARD: Record<string, number> = {
  up: Math.PI / 2,
  left: Math.PI,
  down: -Math.PI / 2,
  right: 0,
};

/** Unit vector, in pixels with y down, of a direction in the robot's frame. */
export function toDirection(angle: number, forward: number): Point {
  return { x: Math.cos(angle + forward), y: -Math.sin(angle + forward) };
}

export function toPixel(projection: Projection, range: number, angle: number): Point {
  const { x, y } = toDirection(angle, projection.forward);
  const length = (range / projection.viewRange) * projection.radius;
  return { x: projection.centerX + length * x, y: projection.centerY + length * y };
}

/** Distance in metres and angle in (-pi, pi] of a point of the picture. */
export function fromPixel(projection: Projection, point: Point): { range: number; angle: number } {
  const dx = point.x - projection.centerX;
  const dy = point.y - projection.centerY;
  const angle = Math.atan2(-dy, dx) - projection.forward;
  return {
    range: (Math.hypot(dx, dy) / projection.radius) * projection.viewRange,
    angle: Math.atan2(Math.sin(angle), Math.cos(angle)),
  };
}

/** Something at the rim: its direction from the scanner, and its extent round the point `gap` beyond the rim. */
export interface Rim {
  direction: Point;
  gap: number;
  halfWidth: number;
  halfHeight: number;
}

/** The rim of the swept area without labels: its ends, and where it crosses the picture's axes. */
export function sweepRim(sweep: Sweep, forward: number): Rim[] {
  const quarters = Array.from({ length: 4 }, (_, i) => (i * Math.PI) / 2 - forward);
  const ends = [angleOf(sweep, 0), angleOf(sweep, Math.max(0, sweep.count - 1))];
  const [from, to] = [Math.min(...ends), Math.max(...ends)];
  const crossed = quarters.filter((quarter) => {
    const turns = Math.ceil((from - quarter) / (2 * Math.PI));
    return isFullCircle(sweep) || quarter + turns * 2 * Math.PI <= to;
  });
  return [...ends, ...crossed].map((angle) => ({
    direction: toDirection(angle, forward),
    gap: 0,
    halfWidth: RIM_MARKS,
    halfHeight: RIM_MARKS,
  }));
}

/** Room for the marks beyond the rim, in pixels. */
export const RIM_MARKS = 8;
const ROBOT = 16;
const MARGIN = 6;

/** The largest radius, and the centre, with which the scanner and everything at the rim fit the box. */
export function fit(rim: Rim[], box: Box): { radius: number; centerX: number; centerY: number } {
  const extent = (radius: number) => {
    const bounds = { left: -ROBOT, right: ROBOT, top: -ROBOT, bottom: ROBOT };
    for (const { direction, gap, halfWidth, halfHeight } of rim) {
      const x = direction.x * (radius + gap);
      const y = direction.y * (radius + gap);
      bounds.left = Math.min(bounds.left, x - halfWidth);
      bounds.right = Math.max(bounds.right, x + halfWidth);
      bounds.top = Math.min(bounds.top, y - halfHeight);
      bounds.bottom = Math.max(bounds.bottom, y + halfHeight);
    }
    return bounds;
  };
  let [low, high] = [10, Math.max(10, box.width + box.height)];
  for (let i = 0; i < 30; i++) {
    const middle = (low + high) / 2;
    const { left, right, top, bottom } = extent(middle);
    if (right - left <= box.width - 2 * MARGIN && bottom - top <= box.height - 2 * MARGIN) low = middle;
    else high = middle;
  }
  const { left, right, top, bottom } = extent(low);
  return {
    radius: low,
    centerX: box.x + (box.width - (right - left)) / 2 - left,
    centerY: box.y + (box.height - (bottom - top)) / 2 - top,
  };
}
