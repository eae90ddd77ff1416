import type { Size } from "../shared/canvas.ts";
import { make, setText } from "../shared/dom.ts";
import type { Box, Point } from "./projection.ts";
import type { RayWords } from "./words.ts";

/** The pop-up that names one ray. */
export class Popup {
  readonly element = make("div", "rw-popup");
  readonly #expression = make("div", "rw-popup-expression rw-index");
  readonly #distance = make("span", "rw-popup-distance");
  readonly #angle = make("span", "rw-popup-angle");
  readonly #details = make("span", "rw-popup-details");
  readonly #side = make("span", "rw-popup-side");

  constructor(parent: HTMLElement) {
    const values = make("div", "rw-popup-row");
    values.append(this.#distance, this.#angle);
    const details = make("div", "rw-popup-row");
    details.append(this.#details, this.#side);
    this.element.append(this.#expression, values, details);
    this.element.hidden = true;
    parent.append(this.element);
  }

  hide(): void {
    this.element.hidden = true;
  }

  /** Shows words at the place that `place` finds for their size. */
  show(words: RayWords, place: (size: Size) => Point): Box {
    this.element.hidden = false;
    setText(this.#expression, words.expression);
    setText(this.#distance, words.distance);
    setText(this.#angle, words.angle);
    setText(this.#details, words.details);
    setText(this.#side, words.side);
    const size = { width: this.element.offsetWidth, height: this.element.offsetHeight };
    const { x, y } = place(size);
    this.element.style.transform = `translate(${Math.round(x)}px, ${Math.round(y)}px)`;
    return { x, y, ...size };
  }
}
