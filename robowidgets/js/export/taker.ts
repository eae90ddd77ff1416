/** Takes bytes one array after the other. */
export class Taker {
  #at = 0;
  readonly #bytes: Uint8Array<ArrayBuffer>;

  constructor(bytes: Uint8Array<ArrayBuffer>) {
    this.#bytes = bytes;
  }

  bytes(count: number): Uint8Array<ArrayBuffer> {
    this.#at += count;
    return this.#bytes.subarray(this.#at - count, this.#at);
  }

  /** Rows of as many bytes each, which Python has sorted by their place in the row: all first ones first. */
  rows(count: number, width: number): Uint8Array<ArrayBuffer> {
    const sorted = this.bytes(count * width);
    const rows = new Uint8Array(count * width);
    for (let place = 0; place < width; place++) {
      for (let row = 0; row < count; row++) rows[row * width + place] = sorted[place * count + row] as number;
    }
    return rows;
  }

  /** Rows of 8-byte numbers, of which Python has left out repeated columns. */
  columns(count: number, places: number[]): Uint8Array<ArrayBuffer> {
    const kept = 1 + Math.max(-1, ...places);
    const columns = Array.from({ length: kept }, () => new BigUint64Array(this.rows(count, 8).buffer));
    const rows = new BigUint64Array(count * places.length);
    for (const [place, index] of places.entries()) {
      const column = columns[index] as BigUint64Array;
      for (let row = 0; row < count; row++) rows[row * places.length + place] = column[row] as bigint;
    }
    return new Uint8Array(rows.buffer);
  }
}
