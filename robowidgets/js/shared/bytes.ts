/** A binary trait as a DataView of exactly its bytes; null when it is empty. */
export function toBytes(value: unknown): DataView | null {
  const view = value instanceof ArrayBuffer ? new DataView(value) : value;
  if (!ArrayBuffer.isView(view) || !view.byteLength) return null;
  return view instanceof DataView ? view : new DataView(view.buffer, view.byteOffset, view.byteLength);
}

/** A copy of some bytes. They may start at any offset of a larger buffer, where a typed array may not. */
export function copyOf({ buffer, byteOffset }: DataView, start: number, length: number): ArrayBuffer {
  return buffer.slice(byteOffset + start, byteOffset + start + length) as ArrayBuffer;
}

/** Reads little-endian numbers one after the other. */
export class Reader {
  #at = 0;
  readonly #bytes: DataView;

  constructor(bytes: DataView) {
    this.#bytes = bytes;
  }

  get left(): number {
    return this.#bytes.byteLength - this.#at;
  }

  float64(): number {
    this.#at += 8;
    return this.#bytes.getFloat64(this.#at - 8, true);
  }

  float64s(count: number): number[] {
    return Array.from({ length: count }, () => this.float64());
  }

  float32s(count: number): Float32Array {
    return new Float32Array(this.bytes(4 * count));
  }

  bytes(count: number): ArrayBuffer {
    this.#at += count;
    return copyOf(this.#bytes, this.#at - count, count);
  }
}
