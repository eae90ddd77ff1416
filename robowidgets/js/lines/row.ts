import { make, set, setHidden, setText, setTip } from "../shared/dom.ts";
import { tokensOf } from "./python.ts";
import type { Line } from "./steps.ts";

/** A line of code with its values. */
export class Row {
  readonly root = make("div", "rw-line");
  readonly graph = make("canvas", "rw-line-graph");
  readonly #value = make("b", "rw-line-value");
  readonly #details = make("span", "rw-line-details");
  readonly #index = make("span", "rw-line-index");
  readonly #times = make("span", "rw-line-times");
  readonly #values = make("span", "rw-line-values");

  /** @param shown the displayed number of the line */
  constructor(shown: number, text: string, isCode: boolean) {
    this.root.role = "row";
    this.root.tabIndex = -1;
    const number = make("span", "rw-line-number", String(shown));
    number.role = "rowheader";
    const code = make("code", "rw-line-code");
    code.role = "cell";
    code.title = text.trim();
    for (const [kind, part] of tokensOf(text)) {
      const piece = make("span", "", part);
      if (kind) piece.dataset.kind = kind;
      code.append(piece);
    }
    this.#values.role = "cell";
    this.#values.append(this.#value, this.#index, this.#details, this.#times);
    this.graph.ariaHidden = "true";
    this.root.append(number, code, this.#values);
    if (isCode) this.root.append(this.graph);
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
