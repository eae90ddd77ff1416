import type { Box } from "./box.ts";

const CELL = 6;

/** The parts of the picture that a label must not cover. */
export class Occupancy {
  readonly #columns: number;
  readonly #rows: number;
  readonly #cells: Uint8Array;

  constructor(width: number, height: number) {
    this.#columns = Math.ceil(width / CELL) + 1;
    this.#rows = Math.ceil(height / CELL) + 1;
    this.#cells = new Uint8Array(this.#columns * this.#rows);
  }

  mark(x: number, y: number): void {
    const [column, row] = [Math.floor(x / CELL), Math.floor(y / CELL)];
    if (column >= 0 && row >= 0 && column < this.#columns && row < this.#rows) {
      this.#cells[row * this.#columns + column] = 1;
    }
  }

  /** Number of marked cells under a box. */
  count({ x, y, width, height }: Box): number {
    let found = 0;
    const last = { column: Math.floor((x + width) / CELL), row: Math.floor((y + height) / CELL) };
    for (let row = Math.max(0, Math.floor(y / CELL)); row <= Math.min(this.#rows - 1, last.row); row++) {
      for (
        let column = Math.max(0, Math.floor(x / CELL));
        column <= Math.min(this.#columns - 1, last.column);
        column++
      ) {
        found += this.#cells[row * this.#columns + column] as number;
      }
    }
    return found;
  }
}
