/** A binary trait as a DataView of exactly its bytes; null when nothing came yet. */
export function toBytes(value: unknown): DataView | null {
  if (value instanceof DataView) return value.byteLength ? value : null;
  if (value instanceof ArrayBuffer) return value.byteLength ? new DataView(value) : null;
  if (ArrayBuffer.isView(value)) {
    return value.byteLength ? new DataView(value.buffer, value.byteOffset, value.byteLength) : null;
  }
  return null;
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

  /** A copy, because the bytes may start at any offset and a typed array may not. */
  float32s(count: number): Float32Array {
    const start = this.#bytes.byteOffset + this.#at;
    this.#at += 4 * count;
    return new Float32Array(this.#bytes.buffer.slice(start, start + 4 * count) as ArrayBuffer);
  }

  uint8s(count: number): Uint8Array {
    const start = this.#bytes.byteOffset + this.#at;
    this.#at += count;
    return new Uint8Array(this.#bytes.buffer.slice(start, start + count) as ArrayBuffer);
  }
}
