import { make, set, setHidden, setText } from "../shared/dom.ts";
import { toCount, toFixed } from "../shared/format.ts";
import type { Model } from "../shared/model.ts";
import type { ComparedVersions, LinesTraits } from "./traits.ts";

const HEADS = ["from", "to", "line", "value before", "value now", "speed before", "speed now"];

/** The steps of the last minute in which the version in force decides otherwise than the one before, as a table. */
export class ComparedTable {
  readonly root = make("details", "rw-lines-compared");
  readonly #summary = make("summary", "");
  readonly #body = make("tbody", "");
  readonly #table = make("table", "");
  readonly #rows = make("div", "rw-lines-compared-rows");
  readonly #model: Model<LinesTraits>;
  #shown: ComparedVersions | null = null;

  constructor(model: Model<LinesTraits>) {
    this.#model = model;
    const head = make("thead", "");
    const row = make("tr", "");
    for (const text of HEADS) {
      const cell = make("th", "", text);
      cell.scope = "col";
      row.append(cell);
    }
    head.append(row);
    this.#table.append(head, this.#body);
    this.#rows.append(this.#table);
    this.root.append(this.#summary, this.#rows);
  }

  /** @param key the version on show */
  draw(key: string): void {
    const compared = this.#model.get("_compared");
    setHidden(this.root, !compared.key || compared.key !== key);
    if (compared === this.#shown) return;
    this.#shown = compared;
    setText(this.#summary, summaryOf(compared));
    const { rows = [] } = compared;
    set(this.root.dataset, "empty", String(!rows.length));
    setHidden(this.#rows, !rows.length);
    this.#body.replaceChildren(
      ...rows.map(([from, to, line, oldValue, newValue, old, now]) => {
        const row = make("tr", "");
        const times = [from, to].map((time) => `${toFixed(time, 2)} s`);
        for (const text of [...times, line === null ? "" : String(line), oldValue, newValue, old, now]) {
          row.append(make("td", "", text));
        }
        return row;
      }),
    );
  }
}

/** Returns the difference of two versions in words. */
export function summaryOf(compared: ComparedVersions): string {
  const { old = 0, new: now = 0, why, steps = 0, seconds = 0, otherwise = 0, failed = 0, error, spans = 0 } = compared;
  const versions = `version ${now} and version ${old}`;
  if (why) return `${versions} were not compared: ${why}`;
  const last = `${toCount(steps)} steps of the last ${toFixed(seconds, 1)} s`;
  if (!otherwise) return `${versions} ask for the same speeds in all ${last}`;
  const times = spans === 1 ? "once" : `${toCount(spans)} times`;
  const fails = failed ? `; version ${now} fails in ${toCount(failed)}: ${error}` : "";
  return `${versions} differ ${times}, in ${toCount(otherwise)} of ${last}${fails}`;
}
