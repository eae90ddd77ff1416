import { make, makeSvg, setHidden, setName, setText } from "../shared/dom.ts";
import { on } from "../shared/events.ts";
import { toFixed } from "../shared/format.ts";
import { digitsWithin, type Entry, type Group, toDigits } from "./groups.ts";
import { fieldOf, toDifference } from "./names.ts";
import type { Measures, Reading } from "./rows.ts";

/** Values at the side of a line. */
export interface Values {
  reading: Reading | null;
  measures: Measures | null;
}

/** Rows below the lines: a state, or a condition. */
export interface More {
  kind: "state" | "mark";
  name: string;
  text: string;
  isOn: boolean;
}

/** Actions of the user on a line. */
export interface LineGestures {
  /** Null after the pointer has left. */
  onPoint(name: string | null): void;
  onSwitch(name: string): void;
}

interface Row {
  value: HTMLElement;
  time: HTMLElement;
  least: HTMLElement;
  mean: HTMLElement;
  most: HTMLElement;
}

interface Difference {
  entries: [Entry, Entry];
  value: HTMLElement;
}

const LEFT = { off: "not drawn", crowded: "no room: switch another line off" };

/** The lines with their values, and the least, mean and greatest of the values on show. */
export class Legend {
  readonly root = make("table", "rw-plot-legend");
  readonly #rows: Row[] = [];
  readonly #gestures: LineGestures;
  readonly #signal: AbortSignal;
  #differences: Difference[] = [];
  #more = make("tbody", "rw-plot-more");
  #shown = "";

  constructor(gestures: LineGestures, signal: AbortSignal) {
    this.root.ariaLabel = "lines";
    this.#gestures = gestures;
    this.#signal = signal;
  }

  /** Makes a row for each line, by its place among all. */
  build(groups: Group[]): void {
    this.#rows.length = 0;
    this.#differences = [];
    const head = make("tr", "rw-plot-head");
    for (const word of ["", "line", "value", "", "least", "mean", "most"]) head.append(make("th", "", word));
    const bodies = groups.map((group) => {
      const body = make("tbody", "");
      for (const entry of group.entries) body.append(this.#line(entry, group.unit));
      const drawn = group.entries.filter(({ left }) => !left);
      if (drawn.length === 2) body.append(this.#difference(drawn as [Entry, Entry], group.unit));
      return body;
    });
    const top = make("thead", "");
    top.append(head);
    this.#shown = "";
    this.root.replaceChildren(top, ...bodies, this.#more);
  }

  update(values: Values[]): void {
    for (const [index, { reading, measures }] of values.entries()) {
      const row = this.#rows[index];
      if (!row) continue;
      setText(row.value, reading ? toValue(reading.value, measures) : "\u2013");
      setText(row.time, reading ? `at ${toFixed(reading.time, 3)} s` : "");
      const digits = digitsWithin(4, measures);
      for (const name of ["least", "mean", "most"] as const) {
        setText(row[name], measures ? toDigits(measures[name], digits) : "\u2013");
      }
    }
    for (const { entries, value } of this.#differences) {
      const [one, other] = entries.map(({ index }) => values[index]?.reading?.value ?? NaN) as [number, number];
      setText(value, Number.isNaN(one - other) ? "\u2013" : toDigits(one - other, 4));
    }
  }

  /** Shows the states and the conditions of a moment. */
  updateMore(more: More[]): void {
    setHidden(this.#more, !more.length);
    const shown = JSON.stringify(more);
    if (shown === this.#shown) return;
    this.#shown = shown;
    this.#more.replaceChildren(
      ...more.map(({ kind, name, text, isOn }) => {
        const row = make("tr", `rw-plot-${kind}`);
        row.classList.toggle("rw-on", isOn);
        const [swatch, title, said] = [make("td", "rw-plot-pen"), make("th", "rw-plot-name"), make("td", "rw-plot-at")];
        swatch.append(make("span", "rw-plot-swatch"));
        title.append(make("span", "", name));
        title.scope = "row";
        said.textContent = text;
        said.colSpan = 5;
        row.append(swatch, title, said);
        return row;
      }),
    );
  }

  #line(entry: Entry, unit: string): HTMLElement {
    const { name, label, index, left, isGhost } = entry;
    const [line, pens, title, value] = [
      make("tr", "rw-plot-line"),
      make("td", "rw-plot-pen"),
      make("th", "rw-plot-name"),
      make("td", "rw-plot-value"),
    ];
    title.scope = "row";
    const button = make("button", "rw-plot-switch");
    button.type = "button";
    button.title = left === "off" ? `${name}: draw it` : `${name}: click to leave it out`;
    button.ariaLabel = name;
    button.ariaPressed = String(left !== "off");
    const field = fieldOf(name);
    const shown = make("b", "");
    setName(shown, label);
    button.append(shown, make("span", "rw-index", field === label ? "" : field));
    title.append(button);
    on(button, "click", () => this.#gestures.onSwitch(name), this.#signal);
    on(line, "pointerenter", () => this.#gestures.onPoint(left ? null : name), this.#signal);
    on(line, "pointerleave", () => this.#gestures.onPoint(null), this.#signal);
    on(button, "focus", () => this.#gestures.onPoint(left ? null : name), this.#signal);
    on(button, "blur", () => this.#gestures.onPoint(null), this.#signal);
    const row: Row = {
      value: make("b", ""),
      time: make("td", "rw-plot-at"),
      least: make("td", "rw-plot-least"),
      mean: make("td", "rw-plot-mean"),
      most: make("td", "rw-plot-most"),
    };
    pens.append(sample(entry));
    line.classList.toggle("rw-plot-off", left !== "");
    line.classList.toggle("rw-plot-ghost", isGhost);
    if (left) {
      const said = make("td", "rw-plot-at rw-plot-left", LEFT[left]);
      said.colSpan = 5;
      line.append(pens, title, said);
      return line;
    }
    value.append(row.value, make("span", "", unit && ` ${unit}`));
    line.append(pens, title, value, row.time, row.least, row.mean, row.most);
    this.#rows[index] = row;
    return line;
  }

  #difference(entries: [Entry, Entry], unit: string): HTMLElement {
    const row = make("tr", "rw-plot-difference");
    const title = make("th", "rw-plot-name");
    title.scope = "row";
    title.title = entries.map(({ name }) => name).join(" \u2212 ");
    title.append(make("span", "", toDifference([entries[0].label, entries[1].label])));
    const [value, number] = [make("td", "rw-plot-value"), make("b", "")];
    value.append(number, make("span", "", unit && ` ${unit}`));
    const rest = make("td", "");
    rest.colSpan = 4;
    row.append(make("td", "rw-plot-pen"), title, value, rest);
    this.#differences.push({ entries, value: number });
    return row;
  }
}

/** A value among others in a span. */
export function toValue(value: number, measures: Measures | null): string {
  return Number.isNaN(value) ? "none" : toDigits(value, digitsWithin(7, measures));
}

/** A piece of a line. */
function sample({ pen: { width, dash } }: Entry): SVGElement {
  const picture = makeSvg("svg", { width: 32, height: 8, "aria-hidden": "true" });
  const at = { x1: 0, y1: 4, x2: 32, y2: 4, stroke: "currentColor" };
  picture.append(makeSvg("line", { ...at, "stroke-width": width, "stroke-dasharray": dash.join(" ") }));
  return picture;
}
