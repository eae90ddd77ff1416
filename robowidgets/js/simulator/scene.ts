import { copyOf, Reader, toBytes } from "../shared/bytes.ts";
import { type Bounds, type Place, type Pose, type Projection, toPixel } from "../shared/floor.ts";
import type { Metres } from "../shared/shapes/places.ts";

interface Disc extends Place {
  radius: number;
}

/** The robot and its surroundings at one moment. */
export interface Scene {
  /** Simulated seconds. */
  time: number;
  robot: Pose & Disc;
  scan: Scan;
  /** Places with their times, oldest first. */
  path: (Place & { time: number })[];
  obstacles: Disc[];
}

/** A scan with angles of the robot, and its pose: the place of the scanner, and the heading of the robot. */
interface Scan extends Pose {
  angleMin: number;
  angleIncrement: number;
  rangeMax: number;
  /** Metres; infinite if nothing was in range, NaN without a reading. */
  ranges: Float32Array;
}

/** Reads a frame as `View` of Python packs it: float64 up to the counts, then float32. */
export function toScene(frame: unknown): Scene | null {
  const bytes = toBytes(frame);
  if (!bytes) return null;
  const reader = new Reader(bytes);
  const [time, x, y, yaw, radius] = reader.float64s(5) as [number, number, number, number, number];
  const [scanX, scanY, scanYaw, angleMin, angleIncrement, rangeMax] = reader.float64s(6) as Six;
  const [rays, places, discs] = reader.float64s(3) as [number, number, number];
  const ranges = reader.float32s(rays);
  const path = triples(reader.float32s(3 * places)).map(([time, x, y]) => ({ time, x, y }));
  const obstacles = triples(reader.float32s(3 * discs)).map(([x, y, radius]) => ({ x, y, radius }));
  const scan = { x: scanX, y: scanY, yaw: scanYaw, angleMin, angleIncrement, rangeMax, ranges };
  return { time, robot: { x, y, yaw, radius }, scan, path, obstacles };
}

type Six = [number, number, number, number, number, number];

function triples(values: Float32Array): [number, number, number][] {
  return Array.from({ length: values.length / 3 }, (_, i) => [...values.subarray(3 * i, 3 * i + 3)] as Triple);
}

type Triple = [number, number, number];

/** The walls, or the drops, as x1, y1, x2, y2 of each. */
export function toWalls(bytes: unknown): Float32Array {
  const view = toBytes(bytes);
  return view ? new Float32Array(copyOf(view, 0, view.byteLength)) : new Float32Array();
}

/** The place on the floor of a point in the frame of the scanner. */
export function toPlace({ x, y, yaw }: Scan, [ahead, left]: Metres): Place {
  const [cos, sin] = [Math.cos(yaw), Math.sin(yaw)];
  return { x: x + cos * ahead - sin * left, y: y + sin * ahead + cos * left };
}

/** A scan with some radians added to its angles, as a laser widget shows it; the readings keep their places. */
export function turnedBy(scan: Scan, radians: number): Scan {
  return { ...scan, angleMin: scan.angleMin + radians, yaw: scan.yaw - radians };
}

/** The end of a ray, in the frame of the scanner; at its reach if nothing was in range, or null without a reading. */
export function endOf({ angleMin, angleIncrement, rangeMax, ranges }: Scan, index: number): Metres | null {
  const [range = NaN, angle] = [ranges[index], angleMin + index * angleIncrement];
  const reach = Math.min(range, rangeMax);
  return Number.isNaN(range) ? null : [reach * Math.cos(angle), reach * Math.sin(angle)];
}

/** The places that the rays reach. */
export function endsOf(scan: Scan): (Place | null)[] {
  return Array.from(scan.ranges, (_, i) => {
    const end = endOf(scan, i);
    return end && toPlace(scan, end);
  });
}

/** Least metres on show round the robot if no wall limits the floor. */
const OPEN = 3;

/** The floor on show: all walls, drops and obstacles, and the robot, rounded to the metre if it is beyond them. */
export function boundsOf(edges: Float32Array[], { robot, obstacles }: Pick<Scene, "robot" | "obstacles">): Bounds {
  const bounds = { west: Infinity, east: -Infinity, south: Infinity, north: -Infinity };
  const hold = (x: number, y: number, margin = 0) => {
    bounds.west = Math.min(bounds.west, x - margin);
    bounds.east = Math.max(bounds.east, x + margin);
    bounds.south = Math.min(bounds.south, y - margin);
    bounds.north = Math.max(bounds.north, y + margin);
  };
  for (const ends of edges) for (let i = 0; i < ends.length; i += 2) hold(ends[i] as number, ends[i + 1] as number);
  for (const { x, y, radius } of obstacles) hold(x, y, radius);
  const margin = edges.some(({ length }) => length) ? robot.radius : OPEN;
  const isInside =
    robot.x - margin >= bounds.west &&
    robot.x + margin <= bounds.east &&
    robot.y - margin >= bounds.south &&
    robot.y + margin <= bounds.north;
  if (!isInside) hold(Math.round(robot.x), Math.round(robot.y), Math.ceil(margin + 0.5));
  return bounds;
}

/** A movable thing: the robot, its heading, or an obstacle by its index. */
export type Thing = "robot" | "heading" | number;

/** Pixels; the robot is never drawn smaller. */
const LEAST_RADIUS = 7;
/** Pixels from the rim of the robot to the handle that turns it. */
const HANDLE = 11;

export function robotRadius({ scale }: Projection, { radius }: Disc): number {
  return Math.max(LEAST_RADIUS, radius * scale);
}

/** The handle that turns the robot, in pixels. */
export function handleOf(projection: Projection, robot: Pose & Disc): Place {
  const { x, y } = toPixel(projection, robot);
  const reach = robotRadius(projection, robot) + HANDLE;
  return { x: x + reach * Math.cos(robot.yaw), y: y - reach * Math.sin(robot.yaw) };
}

/** The thing at a place in pixels: the nearest one that lies within the slop. */
export function thingAt(projection: Projection, scene: Scene, point: Place, slop: number): Thing | null {
  const { robot, obstacles } = scene;
  const away = (place: Place, radius: number) => Math.hypot(place.x - point.x, place.y - point.y) - radius;
  const found: [number, Thing][] = [
    [away(toPixel(projection, robot), robotRadius(projection, robot)), "robot"],
    [away(handleOf(projection, robot), 0), "heading"],
    ...obstacles.map((disc, i): [number, Thing] => [
      away(toPixel(projection, disc), disc.radius * projection.scale),
      i,
    ]),
  ];
  const [distance, thing] = found.reduce((best, other) => (other[0] < best[0] ? other : best));
  return distance <= slop ? thing : null;
}

/** The scene with one thing elsewhere. */
export function withThing(scene: Scene, thing: Thing, { x, y, yaw }: Pose): Scene {
  if (typeof thing !== "number") return { ...scene, robot: { ...scene.robot, x, y, yaw } };
  return { ...scene, obstacles: scene.obstacles.map((disc, i) => (i === thing ? { ...disc, x, y } : disc)) };
}

/** The scene without one obstacle. */
export function withoutObstacle(scene: Scene, index: number): Scene {
  return { ...scene, obstacles: scene.obstacles.filter((_, i) => i !== index) };
}

/** The present pose of a thing; obstacles have no heading. */
export function poseOf({ robot, obstacles }: Scene, thing: Thing): Pose {
  const disc = typeof thing === "number" ? obstacles[thing] : undefined;
  return disc ? { x: disc.x, y: disc.y, yaw: 0 } : { x: robot.x, y: robot.y, yaw: robot.yaw };
}

/** The pose of a thing that is dragged from a place of the floor to another: heading there, or moved as far. */
export function draggedTo(pose: Pose, thing: Thing, from: Place, to: Place): Pose {
  if (thing === "heading") return { ...pose, yaw: Math.atan2(to.y - pose.y, to.x - pose.x) };
  return { ...pose, x: pose.x + to.x - from.x, y: pose.y + to.y - from.y };
}

const STEP = 0.1;
const TURN = Math.PI / 12;
const ARROWS: Record<string, Place> = {
  ArrowLeft: { x: -STEP, y: 0 },
  ArrowRight: { x: STEP, y: 0 },
  ArrowUp: { x: 0, y: STEP },
  ArrowDown: { x: 0, y: -STEP },
};

/** The pose to which a key moves a thing: arrows by 0.1 m, with Shift 0.5 m, brackets turn by 15 degrees. */
export function movedBy(key: string, isShift: boolean, pose: Pose): Pose | null {
  const arrow = ARROWS[key];
  const times = isShift ? 5 : 1;
  if (arrow) return { ...pose, x: pose.x + times * arrow.x, y: pose.y + times * arrow.y };
  if (key !== "[" && key !== "]") return null;
  const yaw = pose.yaw + (key === "[" ? TURN : -TURN);
  return { ...pose, yaw: Math.atan2(Math.sin(yaw), Math.cos(yaw)) };
}
