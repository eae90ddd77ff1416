import { make, setHidden, setText } from "../shared/dom.ts";
import { StateBand } from "../shared/states/band.ts";
import type { StateSpan } from "../shared/states/states.ts";
import type { Theme } from "../shared/theme.ts";

/** The last states as rows, in Python's monotonic seconds; the end of an active state is null. */
export type Rows = [start: number, end: number | null, path: string][][];

const LABELS = 64;
/** Python sends no more. */
const MOST_ROWS = 3;
/** Seconds, and those in a card narrower than some pixels. */
const SECONDS = 30;
const FEW_SECONDS = 10;
const NARROW = 460;

/** The states of the last seconds. A click freezes the moment. */
export class MachineBand {
  readonly root = make("div", "rw-machine-band rw-pale");
  readonly #states: StateBand;
  readonly #first = make("span", "");
  readonly #last = make("span", "");
  #rows: StateSpan[][] = [];
  #end = 0;

  constructor(onPick: (time: number) => void, redraw: () => void, signal: AbortSignal) {
    this.#states = new StateBand("", LABELS, { onPick }, redraw, signal);
    const foot = make("div", "rw-machine-band-foot");
    foot.append(this.#first, this.#last);
    this.root.append(this.#states.root, foot);
  }

  /**
   * While the picture is frozen, the band stays as it was, and the states of the moment on show are highlighted.
   *
   * @param depth levels of machines, for each of which a row keeps its room
   * @param time of the step on show
   * @param word for the right end: "now"
   */
  update(rows: Rows, depth: number, time: number, isFrozen: boolean, word: string, width: number, theme: Theme): void {
    if (!isFrozen || !this.#rows.length) {
      this.#end = time;
      this.#rows = rows.map((row) => row.map(([start, end, path]): StateSpan => [start, end ?? time, path]));
      while (rows.length && this.#rows.length < Math.min(depth, MOST_ROWS)) this.#rows.push([]);
    }
    setHidden(this.root, !this.#rows.length);
    const seconds = width < NARROW ? FEW_SECONDS : SECONDS;
    this.#states.update(this.#rows, [this.#end - seconds, this.#end], time, theme);
    setText(this.#first, `\u2212${seconds} s`);
    setText(this.#last, word);
  }
}
