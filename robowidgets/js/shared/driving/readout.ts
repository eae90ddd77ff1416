import { make, set, setText } from "../dom.ts";
import { toFixed } from "../format.ts";
import { toBar } from "./text.ts";

/** A speed as a number and as a bar from zero to its limit. The bar of a turn to the left goes left. */
export class Readout {
  readonly root = make("div", "rw-readout");
  readonly #value = make("span", "rw-readout-value");
  readonly #limit = make("span", "rw-readout-limit");
  readonly #bar = make("div", "rw-readout-bar");
  readonly #unit: string;
  readonly #side: 1 | -1;

  /** @param namesLimit true if the limit is written above the bar, too */
  constructor(name: string, unit: string, side: 1 | -1, namesLimit: boolean) {
    this.#unit = unit;
    this.#side = side;
    const track = make("div", "rw-readout-track");
    track.append(this.#bar);
    const row = make("div", "rw-readout-row");
    row.append(make("span", "rw-readout-name", name));
    if (namesLimit) row.append(this.#limit);
    const number = make("div", "rw-readout-number");
    number.append(this.#value, make("span", "rw-readout-unit", unit));
    this.root.append(row, number, track);
  }

  update(value: number, limit: number): void {
    setText(this.#value, toFixed(value, 2));
    setText(this.#limit, `limit ±${toFixed(limit, 2)}`);
    Object.assign(this.#bar.style, toBar(this.#side * value, limit));
    set(this.root, "title", `${value} ${this.#unit}`);
  }
}
