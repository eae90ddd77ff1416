import { make } from "../shared/dom.ts";
import { type Group, isShown } from "./axes.ts";
import { Column, toPercent } from "./column.ts";
import type { GroupFacts } from "./facts.ts";
import { scaleLabels, toHeight } from "./scale.ts";
import { toShort } from "./text.ts";

/** The axes of one group side by side, with their scale. */
export class GroupView {
  readonly root = make("div", "rw-group");
  readonly columns: Column[];
  readonly #scale = make("div", "rw-axis rw-scale");
  #key = "";

  constructor(group: Group, planar: boolean) {
    this.columns = group.axes.filter((axis) => isShown(axis, planar)).map((axis) => new Column(axis));
    this.root.style.setProperty("--rw-columns", String(this.columns.length));
    const heading = make("div", "rw-heading", group.name);
    heading.append(" ", make("span", "rw-unit", group.unit));
    const axes = make("div", "rw-axes");
    axes.append(this.#scale, ...this.columns.map(({ root }) => root));
    this.root.append(heading, axes);
  }

  /** @param clearance how close labels may come, as a part of a track */
  update(facts: GroupFacts, clearance: number): void {
    const labelled = facts.shared === null && facts.axes.some(({ limits }) => limits);
    this.#updateScale(facts, labelled, clearance);
    for (const [i, column] of this.columns.entries()) {
      const axisFacts = facts.axes[i];
      if (axisFacts) column.update(axisFacts, labelled, clearance);
    }
  }

  #updateScale({ scale, shared }: GroupFacts, labelled: boolean, clearance: number): void {
    const key = JSON.stringify([scale, shared, labelled, clearance]);
    if (key === this.#key) return;
    this.#key = key;
    this.root.style.setProperty("--rw-zero", toPercent(toHeight(scale, 0)));
    const lane = make("div", "rw-lane");
    const labels = scaleLabels(scale, shared, clearance);
    for (const { value, height, round } of labels) {
      const label = make("span", `rw-scale-label${round ? " rw-round" : ""}`, toShort(value));
      label.style.bottom = toPercent(height);
      lane.append(label);
    }
    this.#scale.replaceChildren(make("div", "rw-axis-name"), lane, make("div", "rw-value"), make("div", "rw-said"));
    this.root.classList.toggle("rw-labelled", labelled);
    const width = (isNarrow: boolean) =>
      Math.max(...labels.filter(({ round }) => !(round && isNarrow)).map(({ value }) => toShort(value).length));
    this.root.style.setProperty("--rw-chars", String(width(false)));
    this.root.style.setProperty("--rw-chars-narrow", String(width(true)));
  }
}
