import { make, setText } from "../shared/dom.ts";
import type { AxisWords } from "./text.ts";

const GAP = 10;
const MARGIN = 4;

/** The pop-up with the exact values of one axis. */
export class Popup {
  readonly #root = make("div", "rw-floating rw-popup");
  readonly #expression = make("span", "rw-popup-expression rw-index");
  readonly #direction = make("span", "rw-popup-side");
  readonly #value = make("div", "rw-popup-distance");
  readonly #alarm = make("div", "rw-popup-alarm");
  readonly #details = make("div", "");
  #words = "";

  constructor(parent: HTMLElement) {
    const head = make("div", "rw-popup-row");
    head.append(this.#expression, this.#direction);
    this.#root.append(head, this.#value, this.#alarm, this.#details);
    this.#root.hidden = true;
    parent.append(this.#root);
  }

  hide(): void {
    this.#root.hidden = true;
  }

  /** Shows words beside an element of the picture. */
  show({ expression, direction, value, alarm, details }: AxisWords, beside: HTMLElement, picture: HTMLElement): void {
    this.#root.hidden = false;
    setText(this.#expression, expression);
    setText(this.#direction, direction);
    setText(this.#value, value);
    setText(this.#alarm, alarm);
    this.#alarm.hidden = !alarm;
    const words = JSON.stringify(details);
    if (this.#words !== words) {
      this.#words = words;
      this.#details.replaceChildren(
        ...details.map(([name, text]) => {
          const row = make("div", "rw-popup-row rw-popup-details");
          row.append(make("span", "", name), make("span", "rw-strong", text));
          return row;
        }),
      );
    }
    const [box, target] = [picture.getBoundingClientRect(), beside.getBoundingClientRect()];
    const { offsetWidth: width, offsetHeight: height } = this.#root;
    const x = placeBeside(target.left - box.left, target.right - box.left, width, box.width);
    const y = Math.max(MARGIN, Math.min(target.top - box.top + GAP, box.height - height - MARGIN));
    this.#root.style.transform = `translate(${Math.round(x)}px, ${Math.round(y)}px)`;
  }
}

/** Left edge of a pop-up: right of the column that it names, else left of it, always inside the box. */
export function placeBeside(left: number, right: number, width: number, boxWidth: number): number {
  const last = boxWidth - width - MARGIN;
  if (right + GAP <= last) return right + GAP;
  return Math.max(MARGIN, Math.min(left - GAP - width, last));
}
