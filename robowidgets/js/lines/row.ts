import { make, set, setHidden, setText, setTip } from "../shared/dom.ts";
import { partsOf, toNumber } from "./numbers.ts";
import type { Line } from "./steps.ts";
import type { NumberCode } from "./traits.ts";

/** The columns of a tab. */
const TAB = 8;

/** The columns before the code of a line. */
function indentOf(text: string): number {
  let columns = 0;
  for (const letter of /^\s*/.exec(text)?.[0] ?? "") columns += letter === "\t" ? TAB - (columns % TAB) : 1;
  return columns;
}

/** A line of code with its values. */
export class Row {
  readonly root = make("div", "rw-line");
  readonly graph = make("canvas", "rw-line-graph");
  /** The numbers that the user can change, in order. */
  readonly literals: { element: HTMLElement; number: NumberCode }[] = [];
  readonly #value = make("b", "rw-line-value");
  readonly #details = make("span", "rw-line-details");
  readonly #index = make("span", "rw-line-index");
  readonly #times = make("span", "rw-line-times");
  readonly #values = make("span", "rw-line-values");

  /**
   * @param shown the displayed number of the line
   * @param numbers the numbers in it
   */
  constructor(shown: number, text: string, isCode: boolean, numbers: NumberCode[] = []) {
    this.root.role = "row";
    this.root.tabIndex = -1;
    const number = make("span", "rw-line-number", String(shown));
    number.role = "rowheader";
    const code = make("code", "rw-line-code");
    code.role = "cell";
    code.title = text.trim();
    code.style.setProperty("--rw-indent", String(indentOf(text)));
    for (const [kind, part, literal] of partsOf(text, numbers)) {
      const piece = make("span", "", part);
      if (kind) piece.dataset.kind = kind;
      code.append(piece);
      if (literal) this.#offer(piece, literal, shown);
    }
    this.#values.role = "cell";
    this.#values.append(this.#value, this.#index, this.#details, this.#times);
    this.graph.ariaHidden = "true";
    this.root.append(number, code, this.#values);
    if (isCode) this.root.append(this.graph);
  }

  /** Lets the user change a number. Its title gives the reason if this is not possible. */
  #offer(element: HTMLElement, number: NumberCode, shown: number): void {
    const [, , text, why] = number;
    element.title = why || "Drag it, or press an arrow up or down: another number";
    if (why) return;
    element.className = "rw-line-literal";
    element.role = "spinbutton";
    element.tabIndex = -1;
    element.ariaLabel = `number in line ${shown}`;
    element.ariaValueNow = String(toNumber(text));
    element.ariaValueText = text;
    this.literals.push({ element, number });
  }

  /** Shows another number in the place of one; null for the one in the source. */
  show(index: number, text: string | null): void {
    const { element, number } = this.literals[index] ?? {};
    if (!element || !number) return;
    const shown = text ?? number[2];
    setText(element, shown);
    set(element, "ariaValueText", shown);
    set(element, "ariaValueNow", String(toNumber(shown)));
    set(element.dataset, "changed", String(text !== null && text !== number[2]));
  }

  /** @param line its values, null if it was not reached, or undefined if it has no code */
  update(line: Line | null | undefined, error: string, given: string): void {
    const state = error ? "failed" : line ? "reached" : line === null ? "not" : "none";
    const [, value = "", details = [], times = 1, kind = "", , rays = []] = line ?? [];
    set(this.root.dataset, "state", state);
    set(this.#value.dataset, "value", kind === "flag" ? value : "");
    setText(this.#value, error || (line === null ? "not reached" : value));
    const indices = rays.filter(([, nearest]) => nearest >= 0).map(([, nearest]) => `[${nearest}]`);
    setText(this.#index, indices.join(" "));
    const text = [...(given ? [given] : []), ...details].join(" \u00b7 ");
    setText(this.#details, text);
    setText(this.#times, times > 1 ? `\u00d7\u2009${times}` : "");
    setHidden(this.#times, times <= 1);
    setTip(this.#values, [error || value, text].filter(Boolean).join("\n"));
  }
}
