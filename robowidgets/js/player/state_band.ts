import { type TimeAxis, toTime } from "../scanogram/axis.ts";
import { drawActive, drawStates, ROW, ROW_STEP, type StateSpan, statesAt, toWords } from "../scanogram/states.ts";
import { Layer, type Surface, watchSize } from "../shared/canvas.ts";
import { make } from "../shared/dom.ts";
import { on } from "../shared/events.ts";
import type { Theme } from "../shared/theme.ts";

/** The states of a recorded program below the slider, on the same time. Pointing names them, a click seeks. */
export class StateBand {
  readonly root = make("div", "rw-play-states");
  readonly #layer = new Layer(this.root);
  #size: Surface = { width: 0, height: 0, ratio: 1 };
  #axis: TimeAxis = { span: [0, 1], left: 0, width: 1 };
  #rows: StateSpan[][] = [];
  #drawn: unknown[] = [];

  /** @param point at a time; null: no more */
  constructor(
    seek: (time: number) => void,
    point: (time: number | null) => void,
    redraw: () => void,
    signal: AbortSignal,
  ) {
    this.root.hidden = true;
    watchSize(
      this.root,
      (size) => {
        this.#size = size;
        redraw();
      },
      signal,
    );
    const timeAt = (event: MouseEvent) => toTime(this.#axis, event.clientX - this.root.getBoundingClientRect().left);
    on(this.root, "click", (event) => seek(timeAt(event)), signal);
    const onPointer = (event: PointerEvent) => {
      const time = timeAt(event);
      this.root.title =
        statesAt(this.#rows, time)
          .map(([, , path]) => toWords(path))
          .at(-1) ?? "";
      if (event.pointerType !== "touch") point(time);
    };
    on(this.root, "pointermove", onPointer, signal);
    on(this.root, "pointerleave", () => point(null), signal);
  }

  update(rows: StateSpan[][], span: [number, number], time: number, theme: Theme): void {
    this.#rows = rows;
    this.root.hidden = !rows.length;
    this.root.style.height = `${rows.length * ROW_STEP - (ROW_STEP - ROW)}px`;
    // Compare first: there may be thousands of states, and this runs in every frame while it plays.
    const drawn = [rows, ...span, ...statesAt(rows, time), this.#size, theme.ink, theme.background];
    if (!this.#size.width || (drawn.length === this.#drawn.length && drawn.every((one, i) => one === this.#drawn[i])))
      return;
    this.#drawn = drawn;
    this.#axis = { span, left: 0, width: this.#size.width };
    const context = this.#layer.begin(this.#size);
    for (const [i, row] of rows.entries()) {
      drawStates(context, this.#axis, i * ROW_STEP, row, theme);
      drawActive(context, this.#axis, i * ROW_STEP, row, time, theme);
    }
  }
}
