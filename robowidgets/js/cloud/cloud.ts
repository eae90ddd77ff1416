import { copyOf, Reader } from "../shared/bytes.ts";
import { type Frame, readHead } from "../shared/stream.ts";
import type { Selection } from "./traits.ts";

/**
 * The numbers of a field. A field with several numbers per point has all numbers of the first point, then of the next.
 */
export type Column =
  | Int8Array
  | Uint8Array
  | Int16Array
  | Uint16Array
  | Int32Array
  | Uint32Array
  | Float32Array
  | Float64Array;

/** A field of the points. */
export interface Field {
  name: string;
  type: string;
  /** Numbers for each point. */
  size: number;
  values: Column;
}

/** A cloud with the points that the page has: every `step`-th, or every `step`-th row and column. */
export interface Cloud extends Frame {
  /** Points of the whole cloud, its rows, and how many of the points were not measured. */
  total: number;
  rows: number;
  columns: number;
  unmeasured: number;
  step: number;
  /** Number of points that the page has. */
  count: number;
  fields: Map<string, Field>;
  x: Column;
  y: Column;
  z: Column;
  /** Metres from the origin of the frame; NaN for points that were not measured. */
  distance: Float32Array;
}

interface Facts {
  total: number;
  rows: number;
  step: number;
  drawn: number;
  unmeasured: number;
  fields: [name: string, type: string, size: number][];
}

const ALIGNED = 8;
const ARRAYS: Record<string, new (buffer: ArrayBuffer) => Column> = {
  i1: Int8Array,
  u1: Uint8Array,
  i2: Int16Array,
  u2: Uint16Array,
  i4: Int32Array,
  u4: Uint32Array,
  f4: Float32Array,
  f8: Float64Array,
};

export function decodeCloud(bytes: DataView): Cloud {
  const reader = new Reader(bytes);
  const head = readHead(reader);
  const length = new DataView(reader.bytes(4)).getUint32(0, true);
  const facts = JSON.parse(new TextDecoder().decode(reader.bytes(length))) as Facts;
  let at = bytes.byteLength - reader.left;
  const fields = new Map<string, Field>();
  for (const [name, type, size] of facts.fields) {
    const numbers = ARRAYS[type] ?? Uint8Array;
    const long = facts.drawn * size * Number(type.slice(1));
    at += (ALIGNED - (at % ALIGNED)) % ALIGNED;
    fields.set(name, { name, type, size, values: new numbers(copyOf(bytes, at, long)) });
    at += long;
  }
  const [x, y, z] = ["x", "y", "z"].map((axis) => fields.get(axis)?.values ?? new Float32Array()) as [
    Column,
    Column,
    Column,
  ];
  // A loop: `from` takes twenty times as long.
  const distance = new Float32Array(facts.drawn);
  for (let i = 0; i < distance.length; i++) distance[i] = distanceTo(x[i] as number, y[i] as number, z[i] as number);
  const { total, rows, step, unmeasured, drawn: count } = facts;
  return { ...head, total, rows, columns: rows ? total / rows : 0, step, unmeasured, count, fields, x, y, z, distance };
}

/** The distance from the origin; NaN if a coordinate is infinite, which is not a measurement. */
function distanceTo(x: number, y: number, z: number): number {
  const away = Math.sqrt(x * x + y * y + z * z);
  return Number.isFinite(away) ? away : NaN;
}

/** Number of points per row that the page has. */
export function drawnColumns({ columns, step }: Cloud): number {
  return Math.ceil(columns / step);
}

/** The index in the whole cloud of a point that the page has. */
export function indexOf(cloud: Cloud, i: number): number {
  if (cloud.rows <= 1) return i * cloud.step;
  const [row, column] = placeOf(cloud, i);
  return row * cloud.columns + column;
}

/** The index in the page of a point of the whole cloud; -1 if the page does not have it. */
export function drawnAt(cloud: Cloud, index: number | null): number {
  if (index === null || index >= cloud.total) return -1;
  const { step, rows, columns } = cloud;
  if (rows <= 1) return index % step ? -1 : index / step;
  const [row, column] = [Math.floor(index / columns), index % columns];
  if (row % step || column % step) return -1;
  return (row / step) * drawnColumns(cloud) + column / step;
}

/** Row and column in the whole cloud of a point that the page has. */
export function placeOf(cloud: Cloud, i: number): [row: number, column: number] {
  const wide = drawnColumns(cloud);
  return [Math.floor(i / wide) * cloud.step, (i % wide) * cloud.step];
}

/** The values that colour points or bound them: a field with one number per point, or the distance. */
export function columnOf(cloud: Cloud, name: string): Column | null {
  // As in Python, also where a field has that name.
  if (name === "distance") return cloud.distance;
  const field = cloud.fields.get(name);
  return field?.size === 1 ? field.values : null;
}

/** 1 for each point of the page that is within bounds; null without a selection. */
export function selectedIn(cloud: Cloud, selection: Selection): Uint8Array | null {
  const bands = Object.entries(selection);
  if (!bands.length) return null;
  const found = new Uint8Array(cloud.count).fill(1);
  for (let i = 0; i < cloud.count; i++) if (Number.isNaN(cloud.distance[i])) found[i] = 0;
  for (const [name, band] of bands) {
    const values = columnOf(cloud, name);
    if (!values) {
      found.fill(0);
      continue;
    }
    // As NumPy compares a float32.
    const [low, high] = values instanceof Float32Array ? (band.map(Math.fround) as [number, number]) : band;
    for (let i = 0; i < cloud.count; i++) {
      const value = values[i] as number;
      if (!(value >= low && value <= high)) found[i] = 0;
    }
  }
  return found;
}

export function countOf(found: Uint8Array): number {
  let count = 0;
  for (const one of found) count += one;
  return count;
}

/** The selected point that is nearest to the origin; -1 if there is none. */
export function nearestOf(cloud: Cloud, found: Uint8Array | null): number {
  let [nearest, least] = [-1, Infinity];
  for (let i = 0; i < cloud.count; i++) {
    const away = cloud.distance[i] as number;
    if (away < least && (!found || found[i])) [nearest, least] = [i, away];
  }
  return nearest;
}

/**
 * Returns true if a field holds colours: red, green and blue in the bytes of one number, as depth cameras send them.
 */
export function isColor(name: string): boolean {
  return name === "rgb" || name === "rgba";
}
