import { type PackedFloats, unpackFloats } from "./floats.ts";
import type { Taker } from "./taker.ts";

/** How Python has packed the frames of one widget in a segment; robowidgets/export/segments.py. */
export interface PackedTrack {
  /** Number of frames, and of bytes of all of them. */
  count: number;
  bytes: number;
  abouts: Record<string, unknown>[];
  /** For each 8-byte number of a frame, or of its head, which of the columns holds it. */
  columns?: number[];
  /** The arrays of float32 after the head, of each frame equally long ones. */
  floats?: PackedFloats[];
}

const ROW = 24;

/** The frames as a player takes them: their number, a table of times, their bytes; docs/frames.md has the layout. */
export function unpackTrack({ count, bytes, columns, floats }: PackedTrack, taker: Taker): DataView {
  const track = new Uint8Array(8 + ROW * count + bytes);
  const view = new DataView(track.buffer);
  view.setFloat64(0, count, true);
  track.set(taker.rows(count, ROW), 8);
  const frames = track.subarray(8 + ROW * count);
  if (!columns) {
    frames.set(taker.bytes(bytes));
    return view;
  }
  const heads = taker.columns(count, columns);
  if (!floats) {
    frames.set(heads);
    return view;
  }
  const arrays = floats.map((packed) => new Uint8Array(unpackFloats(packed, taker).buffer));
  const width = 8 * columns.length;
  let [at, next] = [0, 0];
  for (let i = 0; i < count; i++) {
    const end = view.getFloat64(8 + ROW * i + 16, true);
    const length = (end - at - width) / arrays.length;
    frames.set(heads.subarray(width * i, width * (i + 1)), at);
    for (const [j, array] of arrays.entries()) frames.set(array.subarray(next, next + length), at + width + j * length);
    next += length;
    at = end;
  }
  return view;
}
