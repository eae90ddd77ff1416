import type { Box, Point } from "./box.ts";
import { angleFrom, type Sweep, spanOf } from "./frames/scan.ts";

/** The scanner's place in the picture. */
interface Center {
  centerX: number;
  centerY: number;
  /** Pixels from the scanner to the edge of the view. */
  radius: number;
}

/** Maps metres to pixels. */
export interface Projection extends Center {
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

/** Distance in metres and angle in radians, give or take whole turns, of a point of the picture. */
export function fromPixel(projection: Projection, point: Point): { range: number; angle: number } {
  const dx = point.x - projection.centerX;
  const dy = point.y - projection.centerY;
  return {
    range: (Math.hypot(dx, dy) / projection.radius) * projection.viewRange,
    angle: Math.atan2(-dy, dx) - projection.forward,
  };
}

/** Something at the rim: its direction from the scanner, and its extent round the point `gap` beyond the rim. */
export interface Rim {
  direction: Point;
  gap: number;
  halfWidth: number;
  halfHeight: number;
}

/** The rim of the swept area without labels. */
export function sweepRim(sweep: Sweep, forward: number): Rim[] {
  return arcRim(...spanOf(sweep), forward);
}

/** The rim between two angles, counter-clockwise: its ends, and its points on the picture's axes. */
export function arcRim(from: number, to: number, forward: number): Rim[] {
  const quarters = [0, 1, 2, 3].map((i) => angleFrom(from, (i * Math.PI) / 2 - forward));
  return [from, to, ...quarters.filter((quarter) => quarter <= to)].map((angle) => ({
    direction: toDirection(angle, forward),
    gap: 0,
    halfWidth: RIM_MARKS,
    halfHeight: RIM_MARKS,
  }));
}

/** Room for the marks beyond the rim, in pixels. */
export const RIM_MARKS = 7.5;
const ROBOT = 16;
/** Pixels between labels and card; half as many if the area needs all the width. */
const MARGIN = 6;
const NARROW = 340;

/** The box of something at the rim. */
export function rimBox({ centerX, centerY, radius }: Center, { direction, gap, halfWidth, halfHeight }: Rim): Box {
  return {
    x: centerX + direction.x * (radius + gap) - halfWidth,
    y: centerY + direction.y * (radius + gap) - halfHeight,
    width: 2 * halfWidth,
    height: 2 * halfHeight,
  };
}

/** The extent of the scanner and everything at the rim, from the scanner. */
function extentOf(rim: Rim[], radius: number): Box {
  const boxes = rim.map((one) => rimBox({ centerX: 0, centerY: 0, radius }, one));
  const x = Math.min(-ROBOT, ...boxes.map((one) => one.x));
  const y = Math.min(-ROBOT, ...boxes.map((one) => one.y));
  const width = Math.max(ROBOT, ...boxes.map((one) => one.x + one.width)) - x;
  const height = Math.max(ROBOT, ...boxes.map((one) => one.y + one.height)) - y;
  return { x, y, width, height };
}

/** The height that the scanner and everything at the rim take in a width that they fill: a part of that, and pixels. */
export function heightOf(rim: Rim[]): { part: number; pixels: number } {
  const [low, high] = [extentOf(rim, 100), extentOf(rim, 300)];
  const part = Math.min(1, (high.height - low.height) / Math.max(1, high.width - low.width));
  return { part, pixels: low.height + 2 * MARGIN - part * (low.width + 2 * MARGIN) };
}

/** The largest radius, and the centre, with which the scanner and everything at the rim fit the box. */
export function fit(rim: Rim[], box: Box): Center {
  const margin = box.width < NARROW ? MARGIN / 2 : MARGIN;
  let [low, high] = [10, Math.max(10, box.width + box.height)];
  for (let i = 0; i < 30; i++) {
    const middle = (low + high) / 2;
    const { width, height } = extentOf(rim, middle);
    if (width <= box.width - 2 * margin && height <= box.height - 2 * margin) low = middle;
    else high = middle;
  }
  const { x, y, width, height } = extentOf(rim, low);
  return {
    radius: low,
    centerX: box.x + (box.width - width) / 2 - x,
    centerY: box.y + (box.height - height) / 2 - y,
  };
}
