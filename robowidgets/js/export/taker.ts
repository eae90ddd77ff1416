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

  /** Rows of equal width, which Python has stored column by column. */
  rows(count: number, width: number): Uint8Array<ArrayBuffer> {
    const sorted = this.bytes(count * width);
    const rows = new Uint8Array(count * width);
    for (let place = 0; place < width; place++) {
      for (let row = 0; row < count; row++) rows[row * width + place] = sorted[place * count + row] as number;
    }
    return rows;
  }
}
