import { Canvas, type Surface, watchSize, write } from "../canvas.ts";
import { make, pointIn, setHidden } from "../dom.ts";
import { on } from "../events.ts";
import { type Theme, textFont } from "../theme.ts";
import { type Span, type TimeAxis, toTime } from "../time_axis.ts";
import {
  cutName,
  drawActive,
  drawStates,
  machineOf,
  ROW,
  ROW_STEP,
  type StateSpan,
  stateAt,
  statesAt,
  type Tones,
  toWords,
} from "./states.ts";

/** Actions of the user on a band. */
interface Gestures {
  onPick(time: number): void;
  /** Null after the pointer has left. */
  onPoint?(time: number | null): void;
}

/** The states of a program over time, in a separate band. Pointing names them. */
export class StateBand {
  readonly root: HTMLElement;
  readonly #canvas: Canvas;
  /** Pixels left of the states, for the names of machines. */
  readonly #left: number;
  #size: Surface = { width: 0, height: 0, ratio: 1 };
  #span: Span = [0, 1];
  #rows: StateSpan[][] = [];
  readonly #tones: Tones = new Map();
  #drawn: unknown[] = [];

  constructor(className: string, left: number, { onPick, onPoint }: Gestures, redraw: () => void, signal: AbortSignal) {
    this.root = make("div", `rw-states ${className}`);
    this.#canvas = new Canvas(this.root);
    this.#left = left;
    this.root.hidden = true;
    const onSize = (size: Surface) => {
      this.#size = size;
      redraw();
    };
    watchSize(this.root, onSize, signal);
    const timeAt = (event: MouseEvent) => toTime(this.#axis, pointIn(this.root, event).x);
    on(this.root, "click", (event) => onPick(timeAt(event)), signal);
    const onPointer = (event: PointerEvent) => {
      const time = timeAt(event);
      const row = this.#rows[Math.floor(pointIn(this.root, event).y / ROW_STEP)];
      this.root.title = toWords((row && stateAt(row, time)?.[2]) ?? "");
      if (event.pointerType !== "touch") onPoint?.(time);
    };
    on(this.root, "pointermove", onPointer, signal);
    on(this.root, "pointerleave", () => onPoint?.(null), signal);
  }

  /** The axis for its present size: the user may point at it before it is drawn for that. */
  get #axis(): TimeAxis {
    return { span: this.#span, left: this.#left, width: Math.max(1, this.#size.width - this.#left) };
  }

  /** @param time the time whose states are in ink */
  update(rows: StateSpan[][], span: Span, time: number, theme: Theme): void {
    this.#rows = rows;
    this.#span = span;
    setHidden(this.root, !rows.length);
    this.root.style.height = `${rows.length * ROW_STEP - (ROW_STEP - ROW)}px`;
    // Compare first: there may be thousands of states, and this runs in every frame while it plays.
    const drawn = [rows, ...span, ...statesAt(rows, time), this.#size, theme.ink, theme.background];
    const isDrawn = drawn.length === this.#drawn.length && drawn.every((one, i) => one === this.#drawn[i]);
    if (!this.#size.width || isDrawn) return;
    this.#drawn = drawn;
    const axis = this.#axis;
    const context = this.#canvas.begin(this.#size);
    for (const [i, row] of rows.entries()) {
      const top = i * ROW_STEP;
      const label = cutName(context, machineOf(row), this.#left - 8, theme);
      write(context, label, this.#left - 8, top + ROW / 2 + 0.5, theme.muted, textFont(theme), "right");
      drawStates(context, axis, top, row, this.#tones, theme);
      drawActive(context, axis, top, row, time, theme);
    }
  }
}
