import { make, setText } from "../shared/dom.ts";
import { on } from "../shared/events.ts";
import { toFixed, toMany } from "../shared/format.ts";
import type { Mark } from "../shared/marks.ts";

/** Rows of the list; more would be slow to lay out, and nobody reads them. */
const MOST_ROWS = 500;

/** The marks as rows to click on, below the bar: start, length, and what is marked. A click seeks the start. */
export class MarkList {
  readonly root = make("details", "rw-play-list");
  readonly #summary = make("summary", "");
  readonly #rows = make("div", "rw-play-rows");
  readonly #seek: (time: number) => void;
  readonly #signal: AbortSignal;
  #marks: Mark[] = [];
  #current: Element | undefined;

  constructor(seek: (time: number) => void, signal: AbortSignal) {
    this.#seek = seek;
    this.#signal = signal;
    this.root.hidden = true;
    this.root.append(this.#summary, this.#rows);
  }

  /** @param time on show, in seconds from the start of the recording */
  update(marks: Mark[], time: number): void {
    if (marks !== this.#marks) {
      this.#marks = marks;
      this.root.hidden = !marks.length;
      const more = marks.length > MOST_ROWS ? `, the first ${MOST_ROWS} of them` : "";
      setText(this.#summary, toMany(marks.length, "mark") + more);
      this.#rows.replaceChildren(...marks.slice(0, MOST_ROWS).map((mark) => this.#makeRow(mark)));
    }
    if (!this.root.open) return;
    const place = marks.findIndex(([start, end]) => start <= time && time <= Math.max(end, start));
    const current = this.#rows.children[place];
    if (current === this.#current) return;
    this.#current?.removeAttribute("aria-current");
    current?.setAttribute("aria-current", "true");
    this.#current = current;
  }

  #makeRow([start, end, text]: Mark): HTMLElement {
    const row = make("button", "rw-play-row");
    row.type = "button";
    const length = end > start ? `${toFixed(end - start, 2)} s` : "";
    row.append(make("b", "", `${toFixed(start, 2)} s`), make("span", "rw-play-length", length), make("span", "", text));
    on(row, "click", () => this.#seek(start), this.#signal);
    return row;
  }
}
