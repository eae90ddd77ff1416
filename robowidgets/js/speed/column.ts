import { make, setHidden, setText } from "../shared/dom.ts";
import { type Axis, toLabel } from "./axes.ts";
import type { AxisFacts } from "./facts.ts";
import { judge, type State } from "./limits.ts";
import { isOff, toHeight, toHeightOnTrack } from "./scale.ts";
import { stateWords, toShort, toValueText } from "./text.ts";
import type { Limits } from "./traits.ts";

/** The bar of one axis on its track, with limits, command and peaks, and its words below. */
export class Column {
  readonly root = make("div", "rw-axis");
  readonly track = make("div", "rw-track");
  readonly axis: Axis;
  readonly #bar = make("div", "rw-bar");
  readonly #limits = [make("div", "rw-limit"), make("div", "rw-limit")] as const;
  readonly #labels = [make("span", "rw-limit-label"), make("span", "rw-limit-label")] as const;
  readonly #peaks = [make("div", "rw-peak"), make("div", "rw-peak")] as const;
  readonly #tick = make("div", "rw-tick");
  readonly #value = make("div", "rw-value");
  readonly #command = make("div", "rw-command");
  readonly #commandNumber = make("span", "");
  readonly #state = make("div", "rw-axis-state");
  readonly #styles = new Map<HTMLElement, string>();

  constructor(axis: Axis) {
    this.axis = axis;
    this.root.dataset.axis = String(axis.index);
    const name = make("div", "rw-axis-name", toLabel(axis));
    this.track.append(this.#bar, ...this.#peaks, ...this.#limits);
    const lane = make("div", "rw-lane");
    lane.append(this.track, make("div", "rw-zero"), this.#tick, ...this.#labels);
    // The key stands after the number: before it, it reads as a minus sign.
    this.#command.append(
      make("span", "rw-command-word", "cmd "),
      this.#commandNumber,
      make("span", "rw-key rw-key-command"),
    );
    const said = make("div", "rw-said");
    said.append(this.#command, this.#state);
    this.root.append(name, lane, this.#value, said);
  }

  /**
   * @param labelled true if each limit has a label, because axes have different limits
   * @param clearance how close labels may come, as a part of the track
   */
  update(facts: AxisFacts, labelled: boolean, clearance: number): void {
    const { measured, commanded, limits, decimals } = facts;
    this.#drawLimits(facts, labelled, clearance);
    this.#drawBar(facts);
    this.#drawPeaks(facts);
    setHidden(this.#tick, commanded === null || Number.isNaN(commanded));
    if (!this.#tick.hidden) this.#place(this.#tick, facts, commanded ?? 0);
    const text = toValueText(measured, decimals);
    setText(this.#value, text);
    mark(this.#value, "long", String(text.length > 5));
    setHidden(this.#command, commanded === null);
    setText(this.#commandNumber, Number.isNaN(commanded) ? "\u2013" : toValueText(commanded, decimals));
    this.#say(measured === null ? "within" : judge(measured, limits), limits);
  }

  #drawLimits({ limits, scale }: AxisFacts, labelled: boolean, clearance: number): void {
    const isClose = limits !== null && toHeight(scale, limits[1]) - toHeight(scale, limits[0]) < clearance;
    for (const [i, limit] of (limits ?? [0, 0]).entries()) {
      const [line, label] = i ? [this.#limits[1], this.#labels[1]] : [this.#limits[0], this.#labels[0]];
      const bottom = `bottom: ${toPercent(toHeight(scale, limit))}`;
      this.#style(line, bottom);
      this.#style(label, bottom);
      setHidden(line, limit === 0);
      setHidden(label, !labelled || limit === 0);
      setText(label, toShort(limit));
      mark(label, "close", isClose ? (i ? "high" : "low") : "");
    }
  }

  #drawBar({ measured, limits, scale }: AxisFacts): void {
    const value = measured ?? NaN;
    setHidden(this.#bar, Number.isNaN(value));
    mark(this.root, "state", measured === null ? "" : judge(value, limits));
    mark(this.#bar, "cut", isOff(value, scale) ? (value > 0 ? "up" : "down") : "");
    if (Number.isNaN(value)) return;
    const [zero, end] = [toHeight(scale, 0), toHeightOnTrack(scale, value)];
    const from = end < zero ? `top: ${toPercent(1 - zero)}` : `bottom: ${toPercent(zero)}`;
    this.#style(this.#bar, `${from}; height: ${toPercent(Math.abs(end - zero))}`);
  }

  #drawPeaks(facts: AxisFacts): void {
    for (const [i, element] of this.#peaks.entries()) {
      const peak = facts.peaks?.[i ? 1 : 0] ?? NaN;
      setHidden(element, Number.isNaN(peak));
      if (Number.isNaN(peak)) continue;
      this.#place(element, facts, peak);
      mark(element, "state", judge(peak, facts.limits));
    }
  }

  /** Puts a line at a speed, or at the end of the track when the speed lies beyond. */
  #place(line: HTMLElement, { scale }: AxisFacts, value: number): void {
    this.#style(line, `bottom: ${toPercent(toHeightOnTrack(scale, value))}`);
    mark(line, "off", isOff(value, scale) ? (value > 0 ? "up" : "down") : "");
  }

  #say(state: State, limits: Limits | null): void {
    const [sign, word, more] = stateWords(state, limits);
    const said = `${sign} ${word}`;
    if (this.#state.dataset.said === said) return;
    this.#state.dataset.said = said;
    this.#state.replaceChildren(
      ...(sign ? [make("span", "rw-mark", sign), " "] : []),
      word,
      ...(more ? [make("span", "rw-word", ` ${more}`)] : []),
    );
  }

  #style(element: HTMLElement, style: string): void {
    if (this.#styles.get(element) === style) return;
    this.#styles.set(element, style);
    element.style.cssText = style;
  }
}

/** A height from 0 to 1 for a style. */
export function toPercent(height: number): string {
  return `${(100 * height).toFixed(2)}%`;
}

function mark(element: HTMLElement, name: string, value: string): void {
  if (element.dataset[name] !== value) element.dataset[name] = value;
}
