import { make, makeButton, set, setHidden, setText } from "../shared/dom.ts";
import { on, onAbort } from "../shared/events.ts";
import { toCount, toFixed } from "../shared/format.ts";
import { type Model, newName, onChange } from "../shared/model.ts";
import { throttle } from "../shared/schedule.ts";
import type { Theme } from "../shared/theme.ts";
import { drawEffect } from "./effect.ts";
import { type Range, rangeOf, textIn, toNumber } from "./numbers.ts";
import type { ChangedNumber, LinesTraits } from "./traits.ts";

/** Milliseconds between two numbers that are tried while one is dragged. */
const TRY_MS = 100;
/** Milliseconds after which a number is tried again, to be fresh when it is let go. */
const HOLD_MS = 1000;
/** Milliseconds to wait for the first answer of Python. */
const ANSWER_MS = 3000;
/** Steps of the slider for PageUp and PageDown. */
const LEAP = 10;
const KEYS: Record<string, number> = {
  ArrowUp: 1,
  ArrowRight: 1,
  ArrowDown: -1,
  ArrowLeft: -1,
  PageUp: LEAP,
  PageDown: -LEAP,
};

/** The place of a number. */
export interface Place {
  /** The version. */
  key: string;
  /** The key of the function, and its name. */
  function: string;
  name: string;
  /** Its line in the function, from 0. */
  line: number;
  column: number;
  /** Its index among the numbers of the line. */
  index: number;
  text: string;
}

/** A number that is changed: a slider below its line, the effect on the last seconds, and the buttons. */
export class NumberChange {
  readonly root = make("div", "rw-line-change");
  /** The place of the number; null without one. */
  place: Place | null = null;
  readonly slider = make("input", "rw-slider");
  readonly #before = make("span", "rw-line-change-before");
  readonly #value = make("b", "rw-line-change-value");
  readonly #axes = make("div", "rw-line-change-axes");
  #figures: { caption: HTMLElement; canvas: HTMLCanvasElement }[] = [];
  readonly #words = make("span", "rw-line-change-words");
  readonly #put: HTMLButtonElement;
  readonly #undo: HTMLButtonElement;
  readonly #model: Model<LinesTraits>;
  readonly #onChange: () => void;
  readonly #refocus: (place: Place) => void;
  readonly #try: () => void;
  #press = "";
  #range: Range = rangeOf("1");
  #text = "";
  /** The time at which it was let go without a token; null if none waits. */
  #waitsSince: number | null = null;
  /** True between a release and the next press. */
  #isOver = false;
  #timer: ReturnType<typeof setInterval> | undefined;

  /**
   * @param redraw called when the card is to be drawn again: the text of the number has changed
   * @param refocus called with the place of the number if it is closed while it has the focus
   */
  constructor(model: Model<LinesTraits>, redraw: () => void, refocus: (place: Place) => void, signal: AbortSignal) {
    this.#model = model;
    this.#onChange = redraw;
    this.#refocus = refocus;
    this.#try = throttle(() => !this.#isOver && this.#send("try"), TRY_MS, signal);
    this.#put = makeButton("rw-line-change-put", "Let the new number drive (Enter)", () => this.put(), signal, "Drive");
    this.#put.ariaLabel = null;
    this.#undo = makeButton("rw-line-change-undo", "", () => this.escape(), signal);
    this.#undo.ariaLabel = null;
    this.root.role = "row";
    const cell = make("div", "rw-line-change-cell");
    cell.role = "cell";
    this.#words.role = "status";
    const { slider } = this;
    slider.type = "range";
    const row = make("div", "rw-line-change-row");
    row.append(this.#before, slider, this.#value, this.#put, this.#undo);
    cell.append(row, this.#axes, this.#words);
    this.root.append(cell);
    setHidden(this.root, true);
    on(slider, "pointerdown", () => this.#isOver && this.#begin(), signal);
    on(slider, "input", () => this.change(slider.valueAsNumber), signal);
    // Only a pointer lets go: keys are handled by the view.
    on(slider, "pointerup", () => this.#text !== this.place?.text && this.put(), signal);
    onChange(model, ["_number"], () => this.#onAnswer(), signal);
    onAbort(signal, () => clearInterval(this.#timer));
  }

  /** The number on show in the place of the one in the source; null if both are the same. */
  get shown(): string | null {
    return this.place && !this.#isOver ? this.#text : null;
  }

  /** Shows the slider of a number. */
  open(place: Place): void {
    this.close();
    this.place = place;
    setHidden(this.root, false);
    this.#begin();
  }

  /** Follows the number into another version of its source. */
  moveTo(place: Place): void {
    const isSame = place.text === this.place?.text;
    this.place = place;
    if (this.#isOver && !isSame) this.#text = place.text;
  }

  /** Hides the slider; the number in the source stays as it is. */
  close(): void {
    const { place } = this;
    if (!place) return;
    if (!this.#isOver) this.#send("end");
    if (this.root.matches(":focus-within")) this.#refocus(place);
    clearInterval(this.#timer);
    this.place = null;
    this.#press = "";
    this.#isOver = true;
    setHidden(this.root, true);
    this.#onChange();
  }

  /** Tries another number. */
  change(value: number): void {
    if (this.#isOver) this.#begin();
    const text = textIn(this.#range, value);
    if (text === this.#text) return;
    this.#text = text;
    this.#try();
    this.#onChange();
  }

  /** Tries the number that a drag of so many pixels from a start means; 240 px are the whole slider. */
  drag(from: string, pixels: number): void {
    const { low, high } = this.#range;
    this.change(toNumber(from) + (pixels * (high - low)) / 240);
  }

  /** Handles a key on the number or the slider; returns false for other keys. */
  onKey(key: string, isArrow: (key: string) => boolean): boolean {
    if (key === "Escape") this.escape();
    else if (key === "Enter") this.put();
    else if (KEYS[key] && isArrow(key)) {
      if (this.#isOver) this.#begin();
      this.change(toNumber(this.#text) + (KEYS[key] ?? 0) * this.#range.step);
    } else return false;
    return true;
  }

  /** Lets the new number drive. */
  put(): void {
    if (!this.place || this.#isOver || this.#text === this.place.text) return;
    this.#waitsSince = performance.now();
    this.#putNow();
  }

  /** Takes the number back: one that is tried, then one that drives; else hides the slider. */
  escape(): void {
    if (this.#answer?.state === "driving") this.#model.send({ number: "undo", press: this.#press });
    else this.close();
  }

  get #answer(): ChangedNumber | null {
    const answer = this.#model.get("_number");
    return this.#press && answer.press === this.#press ? answer : null;
  }

  #begin(): void {
    const { place } = this;
    if (!place) return;
    this.#press = newName();
    this.#isOver = false;
    this.#waitsSince = null;
    this.#text = place.text;
    this.#range = rangeOf(place.text);
    const { low, high, step } = this.#range;
    Object.assign(this.slider, { min: String(low), max: String(high), step: String(step) });
    this.slider.ariaLabel = `number in ${place.name}, now ${place.text}`;
    clearInterval(this.#timer);
    this.#timer = setInterval(() => !this.#isOver && this.#send("try"), HOLD_MS);
    this.#send("try");
    this.#onChange();
  }

  #send(act: "try" | "put" | "end"): void {
    const { place } = this;
    if (!place) return;
    const { key, line, column } = place;
    const token = this.#answer?.token ?? 0;
    this.#model.send({
      number: act,
      press: this.#press,
      key,
      function: place.function,
      line,
      column,
      text: this.#text,
      token,
    });
  }

  #putNow(): void {
    if (this.#waitsSince === null || !this.#answer?.token) return;
    const isLate = performance.now() - this.#waitsSince > ANSWER_MS;
    this.#waitsSince = null;
    if (isLate) return;
    this.#isOver = true;
    clearInterval(this.#timer);
    this.#send("put");
    this.#onChange();
  }

  #onAnswer(): void {
    this.#putNow();
    const answer = this.#answer;
    if (answer?.state === "refused" && this.#isOver) this.#text = this.place?.text ?? "";
    this.#onChange();
  }

  /** Draws it below its line. */
  draw(theme: Theme, ratio: number): void {
    const { place } = this;
    if (!place) return;
    const answer = this.#answer;
    const isDriving = answer?.state === "driving";
    const before = isDriving || answer?.state === "back" ? (answer.back ?? place.text) : place.text;
    setText(this.#before, before === this.#text ? "" : `${before} \u2192`);
    setText(this.#value, this.#text);
    set(this.slider, "value", String(toNumber(this.#text)));
    set(this.slider, "ariaValueText", this.#text);
    setHidden(this.#put, this.#isOver);
    this.#put.disabled = this.#text === place.text;
    const undo = isDriving ? "Take back" : this.#isOver ? "Close" : "Cancel";
    setText(this.#undo, undo);
    set(this.#undo, "title", `${undo} (Escape)`);
    setText(this.#words, wordsOf(answer, this.#isOver));
    set(this.root.dataset, "state", answer?.state ?? "trying");
    this.#drawAxes(answer, before, theme, ratio);
  }

  #drawAxes(answer: ChangedNumber | null, before: string, theme: Theme, ratio: number): void {
    const wanted = answer?.axes ?? [];
    // The graphs of one number stay until the graphs of the next one are known.
    if (!wanted.length && answer?.state === "trying") return;
    if (this.#figures.length !== wanted.length) {
      this.#figures = wanted.map(() => ({ caption: make("figcaption", ""), canvas: make("canvas", "") }));
      const figures = this.#figures.map(({ caption, canvas }) => {
        const figure = make("figure", "");
        canvas.ariaHidden = "true";
        figure.append(caption, canvas);
        return figure;
      });
      this.#axes.replaceChildren(...figures);
    }
    for (const [i, { caption, canvas }] of this.#figures.entries()) {
      const axis = wanted[i];
      if (!axis) continue;
      setText(caption, `${axis.axis}, ${axis.unit}: thin with ${answer?.text}, wide with ${before}`);
      drawEffect(canvas, axis, theme, ratio);
    }
  }
}

/** Returns the state of a number in words. */
export function wordsOf(answer: ChangedNumber | null, isOver = false): string {
  const { state, why = "", text = "", version = 0, note = "" } = answer ?? {};
  if (state === "refused") return `not changed: ${why}`;
  if (state === "back") return `${text} is back, as version ${version}${note && `; ${note}`}`;
  if (state === "driving") {
    return note ? `${text} is in version ${version}; ${note}` : `${text} drives, as version ${version}`;
  }
  if (state === "tried") return why ? `without a trial: ${why}` : effectOf(answer ?? {});
  return isOver || state === "trying" ? "trying it on the last seconds" : "";
}

function effectOf({ steps = 0, seconds = 0, otherwise = 0, failed = 0, error = "" }: ChangedNumber): string {
  if (!steps) return "no steps to try it on yet";
  const last = `the last ${toFixed(seconds, 1)} s`;
  if (failed) return `it would fail in ${toCount(failed)} of ${toCount(steps)} steps of ${last}: ${error}`;
  if (!otherwise) return `the same speeds in all ${toCount(steps)} steps of ${last}`;
  return `another speed in ${toCount(otherwise)} of ${toCount(steps)} steps of ${last}`;
}
