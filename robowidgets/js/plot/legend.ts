import { make, makeSvg, setText } from "../shared/dom.ts";
import { toFixed } from "../shared/format.ts";
import { type Group, type Pen, toDigits } from "./groups.ts";
import type { Measures, Reading } from "./rows.ts";

/** What stands beside a line. */
export interface Values {
  reading: Reading | null;
  measures: Measures | null;
}

interface Row {
  value: HTMLElement;
  time: HTMLElement;
  least: HTMLElement;
  mean: HTMLElement;
  most: HTMLElement;
}

/** The lines with their exact values, and the least, mean and greatest of what is seen. */
export class Legend {
  readonly root = make("table", "rw-plot-legend");
  readonly #rows: Row[] = [];

  constructor() {
    this.root.ariaLabel = "lines";
  }

  /** Makes a row for each line, by its place among all. */
  build(groups: Group[]): void {
    this.#rows.length = 0;
    const head = make("tr", "rw-plot-head");
    for (const word of ["", "line", "value", "", "least", "mean", "most"]) head.append(make("th", "", word));
    const bodies = groups.map(({ unit, entries }) => {
      const body = make("tbody", "");
      for (const { name, index, pen } of entries) {
        const [title, text] = [make("th", "rw-plot-name"), make("span", "rw-index", name)];
        title.scope = "row";
        title.title = name;
        title.append(text);
        const row: Row = {
          value: make("b", ""),
          time: make("td", "rw-plot-at"),
          least: make("td", "rw-plot-least"),
          mean: make("td", "rw-plot-mean"),
          most: make("td", "rw-plot-most"),
        };
        const [line, pens, value] = [
          make("tr", "rw-plot-line"),
          make("td", "rw-plot-pen"),
          make("td", "rw-plot-value"),
        ];
        pens.append(sample(pen));
        value.append(row.value, make("span", "", unit && ` ${unit}`));
        line.append(pens, title, value, row.time, row.least, row.mean, row.most);
        body.append(line);
        this.#rows[index] = row;
      }
      return body;
    });
    const top = make("thead", "");
    top.append(head);
    this.root.replaceChildren(top, ...bodies);
  }

  update(values: Values[]): void {
    for (const [index, { reading, measures }] of values.entries()) {
      const row = this.#rows[index];
      if (!row) continue;
      setText(row.value, reading ? toValue(reading.value) : "\u2013");
      setText(row.time, reading ? `at ${toFixed(reading.time, 3)} s` : "");
      for (const name of ["least", "mean", "most"] as const) {
        setText(row[name], measures ? toDigits(measures[name], 4) : "\u2013");
      }
    }
  }
}

export function toValue(value: number): string {
  return Number.isNaN(value) ? "none" : toDigits(value, 7);
}

/** A piece of a line. */
function sample({ width, dash }: Pen): SVGElement {
  const picture = makeSvg("svg", { width: 32, height: 8, "aria-hidden": "true" });
  const at = { x1: 0, y1: 4, x2: 32, y2: 4, stroke: "currentColor" };
  picture.append(makeSvg("line", { ...at, "stroke-width": width, "stroke-dasharray": dash.join(" ") }));
  return picture;
}
