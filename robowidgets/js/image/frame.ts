import { copyOf, Reader } from "../shared/bytes.ts";
import { type Frame, readHead } from "../shared/stream.ts";

/** Forms of the bytes of a picture, numbered as in Python. */
export const FILE = 0;
export const RGB = 1;
export const RGBA = 2;
export const GRAY = 3;
export const UINT16 = 4;
export const FLOAT32 = 5;

/** A picture as it comes from Python. */
export interface Picture extends Frame {
  form: number;
  /** Of the whole picture. */
  rows: number;
  columns: number;
  /** Step of the rows and columns that the page has. */
  every: number;
  /** Metres of one step of a depth image; 0 for other images. */
  depthScale: number;
  /** True if the numbers are exactly those in the message. */
  isExact: boolean;
  /** The bytes of the rows and columns that the page has, or of a file. */
  data: Uint8Array<ArrayBuffer>;
}

export function decodeImage(bytes: DataView): Picture {
  const reader = new Reader(bytes);
  const head = readHead(reader);
  const [form = 0, rows = 0, columns = 0, every = 1, depthScale = 0, isExact = 0] = reader.float64s(6);
  const data = new Uint8Array(copyOf(bytes, bytes.byteLength - reader.left, reader.left));
  return { ...head, form, rows, columns, every, depthScale, isExact: isExact === 1, data };
}

/** Number of rows and columns that the page has. */
export function sizeThere({ rows, columns, every }: Pick<Picture, "rows" | "columns" | "every">) {
  return { height: Math.ceil(rows / every), width: Math.ceil(columns / every) };
}

/** Returns true if each pixel is one number, not a color. */
export function isNumbers({ form }: Pick<Picture, "form">): boolean {
  return form === UINT16 || form === FLOAT32;
}

/** The numbers of a picture; metres of a depth image, NaN for 0 and for an invalid distance. */
export function toNumbers(picture: Picture): Float32Array | Uint16Array {
  const { data, depthScale } = picture;
  const values = picture.form === FLOAT32 ? new Float32Array(data.buffer) : new Uint16Array(data.buffer);
  if (!depthScale) return values;
  // A loop: `from` takes twenty times as long.
  const depths = new Float32Array(values.length);
  for (let i = 0; i < depths.length; i++) depths[i] = toDepth(values[i] as number, depthScale);
  return depths;
}

/** Metres; NaN for 0 and for an invalid distance. */
export function toDepth(value: number, scale: number): number {
  return value > 0 && value < Infinity ? value * scale : NaN;
}
