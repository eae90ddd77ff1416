import { make, setHidden, setText, setTip } from "../shared/dom.ts";
import { toCount } from "../shared/format.ts";
import type { Sensor, TouchState } from "../shared/frames/touch.ts";
import { summarize, tellBeside, toTouches } from "./text.ts";

const STATES: TouchState[] = ["touched", "free", "unknown"];

/** The number of sensors in each state, and of all touches. */
export class Footer {
  readonly #counts = new Map<TouchState, HTMLElement>();
  readonly #beside = make("span", "rw-beside");
  readonly #touches = make("span", "rw-touches");
  readonly #unknown: HTMLElement;

  constructor(element: HTMLElement) {
    const list = make("span", "rw-counts");
    for (const state of STATES) {
      const item = make("span", "rw-state");
      const count = make("b", "");
      const swatch = make("span", "rw-swatch");
      swatch.dataset.state = state;
      item.append(swatch, count, state);
      list.append(item);
      this.#counts.set(state, count);
    }
    this.#unknown = list.lastElementChild as HTMLElement;
    element.append(list, this.#beside, this.#touches);
  }

  /**
   * @param all also the sensors that are not on show
   * @param shared the words that the names of the sensors share
   */
  update(sensors: Sensor[], all: Sensor[], shared: string): void {
    const { counts, touches } = summarize(sensors);
    const beside = tellBeside(all, sensors) || shared;
    setText(this.#beside, beside);
    setTip(this.#beside, beside);
    for (const [state, element] of this.#counts) setText(element, toCount(counts[state]));
    // The other two states appear and disappear without moving the rest.
    setHidden(this.#unknown, counts.unknown === 0);
    setText(this.#touches, toTouches(touches));
  }
}
