import type { Box } from "../shared/box.ts";
import { make, set, setBox, setText } from "../shared/dom.ts";
import type { Sensor } from "../shared/frames/touch.ts";
import { heightOf, NARROW } from "./rows.ts";
import { detailOf, tellAll } from "./text.ts";

/** The rectangle of one sensor: its label, and its state in colour and in words. */
export class Tile {
  readonly element = make("div", "rw-tile");
  readonly #label = make("span", "rw-tile-label");
  readonly #state = make("span", "rw-tile-state");
  readonly #detail = make("span", "rw-tile-detail");

  constructor() {
    const words = make("span", "rw-tile-words");
    words.append(this.#state, this.#detail);
    this.element.role = "listitem";
    this.element.append(this.#label, words);
  }

  place(box: Box): void {
    setBox(this.element, box);
    this.element.classList.toggle("rw-narrow", box.width < NARROW);
    this.element.classList.toggle("rw-flat", box.height < heightOf(box.width));
  }

  update(sensor: Sensor, label: string, elapsed: number | null): void {
    set(this.element.dataset, "state", sensor.state);
    this.#setLabel(label);
    setText(this.#state, sensor.state);
    setText(this.#detail, detailOf(sensor, elapsed));
    const all = tellAll(sensor, elapsed);
    if (this.element.title !== all) this.element.title = all;
  }

  /** The label may break after the marks with which programs join words. */
  #setLabel(label: string): void {
    if (this.#label.textContent === label) return;
    const parts = label.split(/(?<=[_:/])/);
    this.#label.replaceChildren(...parts.flatMap((part) => [part, document.createElement("wbr")]));
  }
}
