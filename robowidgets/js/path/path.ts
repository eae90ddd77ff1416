import type { Size } from "../shared/box.ts";
import { Reader, toBytes } from "../shared/bytes.ts";
import { BELOW, type Bounds, MARGIN, type Place, type Pose } from "../shared/floor.ts";
import { firstWhere } from "../shared/search.ts";
import { type Frame, readHead } from "../shared/stream.ts";
import { ticks } from "../shared/ticks.ts";
import { type LayerState, readLayers } from "./layers.ts";

/** A pose at a time in seconds; NaN for a missing value. */
export interface TimedPose extends Pose {
  time: number;
}

/** A place on the path, with metres of the path up to it. */
export interface Point extends TimedPose {
  way: number;
  /** True if the robot jumped to it, such as odometry that was reset. */
  isAfterJump?: boolean;
}

/** Metres by which two points may lie farther apart than the path between them is long. */
const SLACK = 0.15;

export interface PoseFrame extends Frame, TimedPose {
  layers: LayerState[];
}

export function decodePose(bytes: DataView): PoseFrame {
  const reader = new Reader(bytes);
  const head = readHead(reader);
  const [time, x, y, yaw] = reader.float64s(4) as [number, number, number, number];
  return { ...head, time, x, y, yaw, layers: readLayers(reader) };
}

/** The points of a path, oldest first. */
export function toPoints(path: unknown): Point[] {
  const bytes = toBytes(path);
  if (!bytes) return [];
  return readPoints(new Reader(bytes), bytes.byteLength / 40);
}

export function readPoints(reader: Reader, count: number): Point[] {
  let before: Point | undefined;
  return Array.from({ length: count }, () => {
    const [time, x, y, yaw, way] = reader.float64s(5) as [number, number, number, number, number];
    const isAfterJump = before && Math.hypot(x - before.x, y - before.y) > way - before.way + SLACK;
    before = { time, x, y, yaw, way, ...(isAfterJump && { isAfterJump }) };
    return before;
  });
}

export function isKnown({ x, y }: Place): boolean {
  return Number.isFinite(x) && Number.isFinite(y);
}

/** The path up to a pose, which ends there, and the rest. */
export function splitAt(points: Point[], now: TimedPose): { before: Point[]; after: Point[] } {
  const next = firstWhere(points, ({ time }) => time > now.time);
  const [before, after] = [points.slice(0, next), points.slice(next)];
  if (!isKnown(now)) return { before, after };
  const [last, following] = [before.at(-1), after[0]];
  const toLast = last ? Math.hypot(now.x - last.x, now.y - last.y) : 0;
  const isAfterJump = following?.isAfterJump && Math.hypot(now.x - following.x, now.y - following.y) < toLast;
  if (isAfterJump) after[0] = { ...following, isAfterJump: false };
  const here = {
    ...now,
    ...(isAfterJump ? { way: following.way, isAfterJump } : { way: wayTo(now, last, following) }),
  };
  return { before: [...before, here], after: [here, ...after] };
}

/** Metres driven up to a place after the last point; up to the following point, which may lie behind a curve. */
function wayTo(now: Place, last?: Point, following?: Point): number {
  if (!last) return 0;
  const toLast = Math.hypot(now.x - last.x, now.y - last.y);
  if (!following || following.isAfterJump) return last.way + toLast;
  const toNext = Math.hypot(now.x - following.x, now.y - following.y);
  return last.way + ((following.way - last.way) * toLast) / (toLast + toNext || 1);
}

/** The place of a path nearest to another one, between two points if that is nearer; null without a path. */
export function nearestOn(points: Point[], { x, y }: Place): Point | null {
  let [nearest, least]: [Point | null, number] = [points[0] ?? null, Infinity];
  for (const [i, to] of points.entries()) {
    const from = (to.isAfterJump ? null : points[i - 1]) ?? to;
    const [dx, dy] = [to.x - from.x, to.y - from.y];
    const share = Math.min(1, Math.max(0, ((x - from.x) * dx + (y - from.y) * dy) / (dx * dx + dy * dy || 1)));
    const found = between(from, to, share);
    const distance = Math.hypot(found.x - x, found.y - y);
    if (distance < least) [nearest, least] = [found, distance];
  }
  return nearest;
}

/** A place on the path between two points; it turns the shorter way round. */
function between(from: Point, to: Point, share: number): Point {
  const mix = (a: number, b: number) => a + share * (b - a);
  const turn = to.yaw - from.yaw;
  return {
    time: mix(from.time, to.time),
    x: mix(from.x, to.x),
    y: mix(from.y, to.y),
    yaw: from.yaw + share * Math.atan2(Math.sin(turn), Math.cos(turn)),
    way: mix(from.way, to.way),
  };
}

/** Metres from side to side that are shown at least. */
const LEAST = 2;
/** Part of the path's size that is left free round it. */
const ROOM = 0.05;

/**
 * The floor that shows all places and fills a picture. It ends at round metres of the path, so that it does not change
 * with every step of the robot.
 */
export function boundsOf(places: Place[], picture: Size): Bounds {
  const [[west, east], [south, north]] = [placed(places.map(({ x }) => x)), placed(places.map(({ y }) => y))];
  const aspect = Math.max(1, picture.width - 2 * MARGIN) / Math.max(1, picture.height - MARGIN - BELOW);
  const width = Math.max(east - west, (north - south) * aspect);
  const [x, y] = [(west + east) / 2, (south + north) / 2];
  const height = width / aspect;
  return { west: x - width / 2, east: x + width / 2, south: y - height / 2, north: y + height / 2 };
}

/** The multiples of a step in a span; empty if damaged numbers make it endless. */
export function multiples(step: number, from: number, to: number): number[] {
  const count = (to - from) / step;
  if (!Number.isFinite(count)) return [];
  // Counted: to numbers that are large enough, a step adds nothing.
  const values = Array.from({ length: count + 1 }, (_, i) => (Math.ceil(from / step) + i) * step);
  return values.filter((value) => value < to);
}

/** Round ends of a span that holds all values. */
function placed(values: number[]): [number, number] {
  const [low, high] = [
    values.reduce((a, b) => Math.min(a, b), Infinity),
    values.reduce((a, b) => Math.max(a, b), -Infinity),
  ];
  if (!values.length) return [-LEAST / 2, LEAST / 2];
  const room = Math.max(LEAST - (high - low), ROOM * (high - low)) / 2;
  const step = ticks(0, high - low + 2 * room, 5)[1] ?? 1;
  return [Math.floor((low - room) / step) * step, Math.ceil((high + room) / step) * step];
}
