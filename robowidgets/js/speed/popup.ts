import type { Box, Size } from "../shared/box.ts";
import { make, setHidden, setText } from "../shared/dom.ts";
import { LaidOut } from "../shared/laid_out.ts";
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
  readonly #size: LaidOut;
  #words = "";
  #beside: Box = { x: 0, y: 0, width: 0, height: 0 };
  #picture: Size = { width: 0, height: 0 };

  constructor(parent: HTMLElement, signal: AbortSignal) {
    this.#size = new LaidOut(() => this.#place(), signal).of(this.#root);
    const head = make("div", "rw-popup-row");
    head.append(this.#expression, this.#direction);
    this.#root.append(head, this.#value, this.#alarm, this.#details);
    setHidden(this.#root, true);
    parent.append(this.#root);
  }

  hide(): void {
    setHidden(this.#root, true);
  }

  /**
   * Shows words next to a box in the picture.
   *
   * @param picture its size
   */
  show({ expression, direction, value, alarm, details }: AxisWords, beside: Box, picture: Size): void {
    setHidden(this.#root, false);
    setText(this.#expression, expression);
    setText(this.#direction, direction);
    setText(this.#value, value);
    setText(this.#alarm, alarm);
    setHidden(this.#alarm, !alarm);
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
    this.#beside = beside;
    this.#picture = picture;
    this.#place();
  }

  #place(): void {
    const { x: left, y: top, width: wide } = this.#beside;
    const { width, height } = this.#size;
    const x = placeBeside(left, left + wide, width, this.#picture.width);
    const y = Math.max(MARGIN, Math.min(top + GAP, this.#picture.height - height - MARGIN));
    this.#root.style.transform = `translate(${Math.round(x)}px, ${Math.round(y)}px)`;
  }
}

/** Left edge of a pop-up: right of the column that it names, else left of it, always inside the box. */
export function placeBeside(left: number, right: number, width: number, boxWidth: number): number {
  const last = boxWidth - width - MARGIN;
  if (right + GAP <= last) return right + GAP;
  return Math.max(MARGIN, Math.min(left - GAP - width, last));
}
