import type { Point } from "../shared/box.ts";
import type { Speeds } from "../shared/frames/speeds.ts";
import type { Touch, TouchState } from "../shared/frames/touch.ts";
import type { Frame } from "../shared/stream.ts";
import { type Sector, sweepOf } from "./sector.ts";

/** The robot from above in its own frame, metres, with the models of the widgets that know its speed and touches. */
export interface Footprint {
  radius: number | null;
  polygon: [x: number, y: number][];
  /** By the name of a touch sensor. */
  bumpers: Record<string, Sector>;
  /** Of the scanner on the robot. */
  scanner: [x: number, y: number, yaw: number];
  speed: string;
  touch: string;
}

/** Metres, y to the left. */
type Place = Point;

/** Seconds of motion that the arrow shows. */
const AHEAD = 2;
const STEPS = 24;
/** Greatest difference in seconds between a scan and a speed or a touch of the same moment. */
const APART = 1;
/** Below these speeds a robot stands: m/s and rad/s. */
const STANDS = [0.005, 0.02] as const;

/** The robot, enlarged if it would be less than some metres across. */
export function atLeast(robot: Footprint, across: number): Footprint {
  const factor = across / 2 / Math.max(...outlineOf(robot).map(({ x, y }) => Math.hypot(x, y)));
  if (!(factor > 1)) return robot;
  const polygon = robot.polygon.map(([x, y]) => [factor * x, factor * y] as [number, number]);
  return { ...robot, radius: robot.radius && factor * robot.radius, polygon };
}

/** Metres from the middle to the outline in a direction; if the outline has several parts, to the farthest. */
export function reachOf({ radius, polygon }: Footprint, angle: number): number {
  if (radius !== null) return radius;
  const [dx, dy] = [Math.cos(angle), Math.sin(angle)];
  let farthest = 0;
  for (const [i, [ax, ay]] of polygon.entries()) {
    const [bx, by] = polygon[(i + 1) % polygon.length] as [number, number];
    const [ex, ey] = [bx - ax, by - ay];
    const across = dx * ey - dy * ex;
    if (Math.abs(across) < 1e-12) continue;
    const far = (ax * ey - ay * ex) / across;
    const along = (ax * dy - ay * dx) / across;
    if (far > farthest && along >= -1e-9 && along <= 1 + 1e-9) farthest = far;
  }
  return farthest;
}

/** The places of the whole outline. */
export function outlineOf(robot: Footprint): Place[] {
  if (robot.radius === null) return robot.polygon.map(([x, y]) => ({ x, y }));
  return partOf(robot, { start: 0, end: 2 * Math.PI });
}

/** Places along the outline over a sector. */
export function partOf(robot: Footprint, sector: Sector): Place[] {
  const sweep = sweepOf(sector);
  const steps = Math.max(2, Math.ceil(sweep / 0.05));
  return Array.from({ length: steps + 1 }, (_, i) => {
    const angle = sector.start + (i / steps) * sweep;
    const reach = reachOf(robot, angle);
    return { x: reach * Math.cos(angle), y: reach * Math.sin(angle) };
  });
}

/**
 * The path of a point of the outline in the next two seconds: the foremost in the direction of motion. Empty while the
 * robot stands.
 */
export function wayOf(robot: Footprint, vx: number, vy: number, turn: number): Place[] {
  const moves = Math.hypot(vx, vy) >= STANDS[0];
  if (!moves && !(Math.abs(turn) >= STANDS[1])) return [];
  const front = moves ? Math.atan2(vy, vx) : 0;
  const reach = reachOf(robot, front);
  const way: Place[] = [];
  let [x, y, yaw] = [0, 0, 0];
  for (let i = 0; i <= STEPS; i++) {
    way.push({ x: x + reach * Math.cos(front + yaw), y: y + reach * Math.sin(front + yaw) });
    const step = AHEAD / STEPS;
    const middle = yaw + (turn * step) / 2;
    x += (vx * Math.cos(middle) - vy * Math.sin(middle)) * step;
    y += (vx * Math.sin(middle) + vy * Math.cos(middle)) * step;
    yaw += turn * step;
  }
  return way;
}

/** Distance and angle, as a scan has them, of a place on the robot. */
export function asSeen({ scanner: [sx, sy, yaw] }: Footprint, { x, y }: Place): { range: number; angle: number } {
  return { range: Math.hypot(x - sx, y - sy), angle: Math.atan2(y - sy, x - sx) - yaw };
}

/** The measured speed when a scan arrived, by axis; null if unknown. */
export function speedAt(scan: Frame | null, speeds: Speeds | null): number[] | null {
  return (!isApart(scan, speeds) && speeds?.measured) || null;
}

/**
 * The states of touch sensors when a scan arrived, by name. Earlier states still hold: a sensor may send changes only.
 */
export function touchesAt(scan: Frame | null, touch: Touch | null): Map<string, TouchState> {
  const isLater = scan && touch && touch.arrived > scan.arrived && isApart(scan, touch);
  return new Map(isLater ? [] : touch?.sensors.map(({ name, state }) => [name, state]));
}

/** False in a player: it has no rate, and a sample arrives when it is read. */
function isApart(scan: Frame | null, sample: Frame | null): boolean {
  if (!scan || !sample || !(scan.rate > 0)) return false;
  const delay = sample.arrived - scan.arrived;
  // The scan of a slow scanner is the last one for longer.
  return delay < -APART || delay > Math.max(APART, 2 / scan.rate);
}
