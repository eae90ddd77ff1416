import type { Reader } from "../shared/bytes.ts";
import type { Place, Pose } from "../shared/floor.ts";
import { type Point, readPoints } from "./path.ts";

/** Facts about a layer, from Python. */
export interface LayerAbout {
  number: number;
  name: string;
  kind: "pose" | "goal" | "poses" | "path" | "scan" | "cone" | "grid";
  /**
   * The frame in which it is drawn, if nothing joins that to the frame of the map; missing for the frame of the map.
   */
  frame?: string;
  /** For a grid, the value of a cell that is certainly occupied: 100, or 254 for costs. */
  most?: number;
  note?: string;
}

/** Square cells in rows from the origin; 255 is unknown. */
export interface Cells {
  rows: number;
  columns: number;
  /** Metres from cell to cell. */
  size: number;
  /** Cells of the map to the side of each. */
  step: number;
  data: Uint8Array;
}

/** State of a layer at the time of a frame, in the frame of the map. */
export interface LayerState extends Pose {
  number: number;
  time: number;
  /** Covariance of x, of x and y, and of y, in square metres; NaN if unknown. */
  scatter: [xx: number, xy: number, yy: number];
  /** The drawn points of a path, a scan or poses; for a cone, its sensor and then its arc. */
  points: Pose[];
  /** Points in the message. */
  total: number;
  /** Version of its large grid, as in `_grids`; 0 without one. */
  version: number;
  cells: Cells | null;
}

/** Reads the layers that follow in a frame. */
export function readLayers(reader: Reader): LayerState[] {
  const layers: LayerState[] = [];
  while (reader.left > 0) {
    const [number = 0, time = NaN, x = NaN, y = NaN, yaw = NaN, ...rest] = reader.float64s(13);
    const [xx = NaN, xy = NaN, yy = NaN, total = 0, version = 0, size = NaN, rows = 0, columns = 0] = rest;
    const scatter: LayerState["scatter"] = [xx, xy, yy];
    const layer: LayerState = { number, time, x, y, yaw, scatter, points: [], total, version, cells: null };
    if (Number.isNaN(size)) layer.points = readPlaces(reader, rows, columns);
    else {
      const data = new Uint8Array(reader.bytes(rows * columns));
      layer.cells = { rows, columns, size, step: 1, data };
    }
    layers.push(layer);
  }
  return layers;
}

/** Places relative to the first of them; yaw is NaN for positions. */
function readPlaces(reader: Reader, rows: number, columns: number): Pose[] {
  const [left = 0, low = 0] = reader.float64s(2);
  const values = reader.float32s(rows * columns);
  return Array.from({ length: rows }, (_, i) => {
    const at = i * columns;
    const yaw = columns > 2 ? (values[at + 2] as number) : NaN;
    return { x: left + (values[at] as number), y: low + (values[at + 1] as number), yaw };
  });
}

/** The paths of layers, by their numbers. */
export function toTracks(reader: Reader | null): Map<number, Point[]> {
  const tracks = new Map<number, Point[]>();
  while (reader && reader.left > 0) {
    const [number = 0, count = 0] = reader.float64s(2);
    tracks.set(number, readPoints(reader, count));
  }
  return tracks;
}

/** A large grid of a layer, as it was sent. */
export interface PackedGrid extends Omit<Cells, "data"> {
  number: number;
  /** Version of the grid; later ones have greater numbers. */
  version: number;
  packed: ArrayBuffer;
}

export function toPackedGrids(reader: Reader | null): PackedGrid[] {
  const grids: PackedGrid[] = [];
  while (reader && reader.left > 0) {
    const [number = 0, version = 0, rows = 0, columns = 0, size = 1, step = 1, length = 0] = reader.float64s(7);
    grids.push({ number, version, rows, columns, size, step, packed: reader.bytes(length) });
  }
  return grids;
}

/** Inflates a grid. */
export async function inflate({ packed, rows, columns, size, step }: PackedGrid): Promise<Cells> {
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return { rows, columns, size, step, data: new Uint8Array(await new Response(stream).arrayBuffer()) };
}

/** The row and the column of the cell at a place; null outside of the grid. */
export function cellAt({ rows, columns, size }: Cells, corner: Pose, at: Place): [row: number, column: number] | null {
  const [dx, dy] = [at.x - corner.x, at.y - corner.y];
  const [cos, sin] = [Math.cos(corner.yaw), Math.sin(corner.yaw)];
  const [row, column] = [Math.floor((dy * cos - dx * sin) / size), Math.floor((dx * cos + dy * sin) / size)];
  return row >= 0 && row < rows && column >= 0 && column < columns ? [row, column] : null;
}

/** The value of a cell as in messages; -1 if unknown. */
export function cellValue({ data, columns }: Cells, row: number, column: number, most: number): number {
  const byte = data[row * columns + column] as number;
  if (byte === 255) return -1;
  return most <= 127 && byte > 127 ? byte - 256 : byte;
}

/** A word for the value of a cell. */
export function wordOf(value: number, most: number): string {
  if (value < 0) return value === -1 ? "unknown" : "no such value";
  if (most > 127) return value === 0 ? "free" : value >= 253 ? "too close" : "near something";
  if (value > most) return "no such value";
  return value >= 65 ? "occupied" : value <= 25 ? "free" : "in between";
}

/** The corners of the known part of a grid; empty if all cells are unknown. */
export function cornersOf({ rows, columns, size, data }: Cells, corner: Pose): Place[] {
  let [left, right, low, high] = [columns, -1, rows, -1];
  for (let row = 0; row < rows; row++) {
    for (let column = 0; column < columns; column++) {
      if (data[row * columns + column] === 255) continue;
      left = Math.min(left, column);
      right = Math.max(right, column);
      low = Math.min(low, row);
      high = row;
    }
  }
  if (right < 0) return [];
  const [cos, sin] = [Math.cos(corner.yaw), Math.sin(corner.yaw)];
  const xs = [left * size, (right + 1) * size];
  return [low * size, (high + 1) * size].flatMap((y) =>
    xs.map((x) => ({ x: corner.x + x * cos - y * sin, y: corner.y + x * sin + y * cos })),
  );
}

/** Standard deviations within which a place lies in 95 of 100 cases, in the plane. */
const SURE = Math.sqrt(5.991);

/** The ellipse that holds a place in 95 of 100 cases: half its axes in metres, and the direction of the longer one. */
export function ellipseOf([xx, xy, yy]: LayerState["scatter"]): { long: number; short: number; yaw: number } | null {
  if (Number.isNaN(xx)) return null;
  const [middle, apart] = [(xx + yy) / 2, Math.hypot((xx - yy) / 2, xy)];
  return {
    long: SURE * Math.sqrt(Math.max(0, middle + apart)),
    short: SURE * Math.sqrt(Math.max(0, middle - apart)),
    yaw: Math.atan2(2 * xy, xx - yy) / 2,
  };
}

/** Metres from a place to the nearest point of a line through others; NaN without one. */
export function distanceTo(line: readonly Place[], { x, y }: Place): number {
  let least = line.length ? Infinity : NaN;
  for (const [i, to] of line.entries()) {
    const from = line[i - 1] ?? to;
    const [dx, dy] = [to.x - from.x, to.y - from.y];
    const share = Math.min(1, Math.max(0, ((x - from.x) * dx + (y - from.y) * dy) / (dx * dx + dy * dy || 1)));
    least = Math.min(least, Math.hypot(from.x + share * dx - x, from.y + share * dy - y));
  }
  return least;
}

/** Metres of a line through places. */
export function lengthOf(line: readonly Place[]): number {
  return line.slice(1).reduce((sum, { x, y }, i) => sum + Math.hypot(x - (line[i]?.x ?? x), y - (line[i]?.y ?? y)), 0);
}

/** The layer that is the robot: of poses that are on show, one with a covariance, else one of tf, else the first. */
export function robotOf(
  layers: readonly LayerAbout[],
  states: ReadonlyMap<number, LayerState>,
): LayerAbout | undefined {
  const poses = layers.filter(({ number, kind }) => kind === "pose" && Number.isFinite(states.get(number)?.x));
  return (
    poses.find(({ number, name }) => !/odom/i.test(name) && !Number.isNaN(states.get(number)?.scatter[0])) ??
    poses.find(({ name }) => name.includes("->")) ??
    poses[0]
  );
}
