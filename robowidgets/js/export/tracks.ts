import { type PackedFloats, unpackFloats } from "./floats.ts";
import type { Taker } from "./taker.ts";

/** Packing of the frames of all widgets in a segment by Python; robowidgets/export/segments.py. */
export interface PackedTracks {
  /**
   * For each column of 8-byte numbers, their number and the scale by which they become whole, or 0 if there is no such
   * scale.
   */
  columns: [count: number, scale: number][];
  tracks: PackedTrack[];
}

/** The frames of one widget. */
interface PackedTrack {
  /** Number of frames, and bytes of all frames together. */
  count: number;
  bytes: number;
  abouts: Record<string, unknown>[];
  /** The columns of the table of times. */
  table: number[];
  /** For each 8-byte number of a frame, or of its head, the index of the column that holds it. */
  columns?: number[];
  /** The arrays of float32 after the head; each frame has arrays of the same lengths. */
  floats?: PackedFloats[];
}

const TABLE_WIDTH = 24;

/** The tracks as a player takes them: number of frames, a table of times, their bytes; docs/developers/frames.md has the layout. */
export function unpackTracks({ columns, tracks }: PackedTracks, taker: Taker): DataView[] {
  const shared = columns.map(([count, scale]) => unpackColumn(new BigUint64Array(taker.rows(count, 8).buffer), scale));
  return tracks.map((track) => unpackTrack(track, shared, taker));
}

function unpackTrack(packed: PackedTrack, shared: BigUint64Array[], taker: Taker): DataView {
  const { count, bytes, columns, floats } = packed;
  const rowsOf = (places: number[]) => toRows(places, shared, count);
  const track = new Uint8Array(8 + TABLE_WIDTH * count + bytes);
  const view = new DataView(track.buffer);
  view.setFloat64(0, count, true);
  track.set(rowsOf(packed.table), 8);
  const frames = track.subarray(8 + TABLE_WIDTH * count);
  if (!columns) {
    frames.set(taker.bytes(bytes));
    return view;
  }
  const heads = rowsOf(columns);
  if (!floats) {
    frames.set(heads);
    return view;
  }
  const arrays = floats.map((array) => new Uint8Array(unpackFloats(array, taker).buffer));
  const width = 8 * columns.length;
  let [at, next] = [0, 0];
  for (let i = 0; i < count; i++) {
    const end = view.getFloat64(8 + TABLE_WIDTH * i + 16, true);
    const length = (end - at - width) / arrays.length;
    frames.set(heads.subarray(width * i, width * (i + 1)), at);
    for (const [j, array] of arrays.entries()) frames.set(array.subarray(next, next + length), at + width + j * length);
    next += length;
    at = end;
  }
  return view;
}

/** The bits of the numbers of a column; Python may have packed their changes instead. */
function unpackColumn(packed: BigUint64Array<ArrayBuffer>, scale: number): BigUint64Array {
  if (!scale) return packed;
  let whole = 0n;
  const values = Float64Array.from(packed, (change) => {
    whole += change & 1n ? -(change >> 1n) - 1n : change >> 1n;
    return Number(whole) / scale;
  });
  return new BigUint64Array(values.buffer);
}

/** The bytes of rows; each place of a row takes its numbers from a column. */
function toRows(places: number[], columns: BigUint64Array[], count: number): Uint8Array {
  const rows = new BigUint64Array(count * places.length);
  for (const [place, index] of places.entries()) {
    const column = columns[index] as BigUint64Array;
    for (let row = 0; row < count; row++) rows[row * places.length + place] = column[row] as bigint;
  }
  return new Uint8Array(rows.buffer);
}
