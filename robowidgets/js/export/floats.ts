import type { Taker } from "./taker.ts";

/** Packing of float32 numbers by Python; robowidgets/export/_floats.py. */
export interface PackedFloats {
  /** All numbers are multiples of it, or special; 0 if they have no common step. */
  step: number;
  count: number;
  /** Number of changes, of changes that take more than a byte, and of values that are listed by their bits. */
  small: number;
  large: number;
  other: number;
}

/** The bits of NaN, infinity, minus infinity and 0, which are classes 1 to 4. */
const CLASSES = [0, 0x7fc00000, 0x7f800000, 0xff800000, 0];
const ESCAPE = 255;

/** The bits of the numbers. */
export function unpackFloats(
  { step, count, small, large, other }: PackedFloats,
  taker: Taker,
): Uint32Array<ArrayBuffer> {
  if (!step) return new Uint32Array(taker.rows(count, 4).buffer);
  const classes = taker.bytes(count);
  const changes = taker.bytes(small);
  const larges = new Uint32Array(taker.rows(large, 4).buffer);
  const others = new Uint32Array(taker.rows(other, 4).buffer);
  const values = new Float32Array(count);
  const bits = new Uint32Array(values.buffer);
  let [nextChange, nextLarge, nextOther, whole] = [0, 0, 0, 0];
  for (let i = 0; i < count; i++) {
    const kind = classes[i] as number;
    if (kind === 0) {
      let folded = changes[nextChange++] as number;
      if (folded === ESCAPE) folded = larges[nextLarge++] as number;
      whole += folded % 2 ? -(folded + 1) / 2 : folded / 2;
      values[i] = whole * step;
    } else {
      bits[i] = (kind < CLASSES.length ? CLASSES[kind] : others[nextOther++]) as number;
    }
  }
  return bits;
}
