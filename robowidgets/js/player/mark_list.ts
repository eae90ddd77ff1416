import { make, makeButton, set, setHidden, setText } from "../shared/dom.ts";
import { on } from "../shared/events.ts";
import { MINUTE, toFixed, toMinutes } from "../shared/format.ts";
import { describeMark, type Mark } from "../shared/marks.ts";

/** Rows of the list; more would be slow to lay out, and too many to read. */
const MOST_ROWS = 500;

/** The marks as rows of buttons, below the bar: start, length, and name. A click seeks the start. */
export class MarkList {
  /** In the bar: the number of the mark on show, and the number of marks; it unfolds the rows. */
  readonly toggle: HTMLButtonElement;
  readonly rows = make("div", "rw-play-rows");
  readonly #number = make("span", "");
  readonly #label = make("span", "rw-play-mark-label");
  readonly #seek: (time: number) => void;
  readonly #signal: AbortSignal;
  #marks: Mark[] = [];
  #current: Element | undefined;

  constructor(seek: (time: number) => void, signal: AbortSignal) {
    this.#seek = seek;
    this.#signal = signal;
    this.toggle = makeButton("rw-play-mark-words", "", () => this.#onToggle(), signal);
    this.toggle.ariaLabel = null;
    this.toggle.ariaExpanded = "false";
    this.toggle.append(this.#number, this.#label, make("span", "rw-play-unfold", "\u25be"));
    this.rows.hidden = true;
  }

  /** @param time on show, in seconds from the start of the recording */
  update(marks: Mark[], time: number): void {
    if (marks !== this.#marks) {
      this.#marks = marks;
      const rows = marks.slice(0, MOST_ROWS).map((mark) => this.#makeRow(mark));
      if (marks.length > MOST_ROWS) rows.push(make("div", "rw-play-more", `the first ${MOST_ROWS} marks`));
      this.rows.replaceChildren(...rows);
      if (!marks.length) this.rows.hidden = true;
    }
    const { number, label } = describeMark(marks, time);
    setText(this.#number, number);
    setText(this.#label, label && `: ${label}`);
    set(
      this.toggle,
      "title",
      `${this.toggle.ariaExpanded === "true" ? "Fold" : "List"} the marks${label && `\n${label}`}`,
    );
    if (this.rows.hidden) return;
    const place = marks.findIndex(([start, end]) => start <= time && time <= Math.max(end, start));
    const current = this.rows.children[place];
    if (current === this.#current) return;
    this.#current?.removeAttribute("aria-current");
    current?.setAttribute("aria-current", "true");
    this.#current = current;
  }

  #onToggle(): void {
    setHidden(this.rows, !this.rows.hidden);
    this.toggle.ariaExpanded = String(!this.rows.hidden);
  }

  #makeRow([start, end, text]: Mark): HTMLElement {
    const row = make("button", "rw-play-row");
    row.type = "button";
    const length = end > start ? `${toFixed(end - start, 2)} s` : "";
    row.append(
      make("b", "", `${toMinutes(start, 2)}${start < MINUTE ? " s" : ""}`),
      make("span", "rw-play-length", length),
      make("span", "", text),
    );
    on(row, "click", () => this.#seek(start), this.#signal);
    return row;
  }
}
