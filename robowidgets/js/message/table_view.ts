import { make, set, setHidden, setText } from "../shared/dom.ts";
import type { Cell, Table, TableRow } from "./table.ts";

/** The elements of a cell. */
class CellView {
  readonly root = make("td", "rw-message-cell");
  readonly #text = make("b", "");
  readonly #unit = make("span", "rw-message-unit");
  readonly #more = make("span", "rw-message-more");
  readonly #bar = make("div", "rw-message-bar");
  readonly #fill = make("div", "rw-message-fill");
  readonly #zero = make("div", "rw-message-zero");
  readonly #ends = make("div", "rw-message-ends");
  readonly #low = make("span", "");
  readonly #high = make("span", "");

  constructor() {
    const line = make("div", "rw-message-line");
    line.append(this.#more, this.#text, this.#unit);
    this.#bar.append(this.#fill, this.#zero);
    this.#bar.ariaHidden = "true";
    this.#ends.append(this.#low, this.#high);
    this.root.append(line, this.#bar, this.#ends);
  }

  update({ text, unit, more, isNone, bar }: Cell): void {
    setText(this.#text, text);
    set(this.#text, "title", text);
    setText(this.#unit, unit);
    setText(this.#more, more);
    this.root.classList.toggle("rw-message-none", isNone);
    setHidden(this.#bar, !bar && !isNone);
    setHidden(this.#ends, !bar?.ends.join(""));
    this.#bar.classList.toggle("rw-message-unknown", !bar);
    if (!bar) {
      this.#fill.style.width = "0";
      setHidden(this.#zero, true);
      return;
    }
    const toPart = (value: number) => Math.min(1, Math.max(0, (value - bar.low) / (bar.high - bar.low)));
    const [from, to] = [toPart(bar.from), toPart(bar.value)];
    this.#fill.style.left = `${100 * Math.min(from, to)}%`;
    this.#fill.style.width = `${100 * Math.abs(to - from)}%`;
    setHidden(this.#zero, bar.low >= 0);
    this.#zero.style.left = `${100 * from}%`;
    setText(this.#low, bar.ends[0]);
    setText(this.#high, bar.ends[1]);
  }
}

/** Sets a name whose lines may end after each of its parts: the names of joints often differ in one part. */
function setBreakable(element: HTMLElement, name: string): void {
  if (element.textContent === name) return;
  element.replaceChildren(...name.split(/(?<=[_/])/).flatMap((part) => [part, make("wbr", "")]));
}

/** The elements of a row. */
class TableRowView {
  readonly root = make("tr", "rw-message-tr");
  readonly inner = make("tr", "rw-message-inner");
  readonly #name = make("span", "");
  readonly #index = make("span", "rw-index");
  readonly #cells: CellView[];
  readonly #pairs = make("td", "");

  constructor(columns: number) {
    const head = make("th", "rw-message-name");
    head.scope = "row";
    head.append(this.#name, this.#index);
    this.#cells = Array.from({ length: columns }, () => new CellView());
    this.root.append(head, ...this.#cells.map(({ root }) => root));
    this.#pairs.colSpan = columns + 1;
    this.inner.append(this.#pairs);
  }

  update({ name, index, cells, inner, level }: TableRow, isChanged: boolean, isOpen: boolean): void {
    setBreakable(this.#name, name);
    setText(this.#index, index);
    for (const [i, cell] of cells.entries()) this.#cells[i]?.update(cell);
    this.root.classList.toggle("rw-message-changed", isChanged);
    if (level === null) delete this.root.dataset.rwLevel;
    else set(this.root.dataset, "rwLevel", String(Math.min(3, Math.max(0, level))));
    if (inner.length) set(this.root, "ariaExpanded", String(isOpen));
    this.root.classList.toggle("rw-message-unfolds", inner.length > 0);
    setHidden(this.inner, !isOpen || !inner.length);
    if (this.inner.hidden) return;
    setText(this.#pairs, inner.map(([key, value]) => `${key}: ${value}`).join("\n"));
  }
}

/** Rows with bars, as a table. */
export class TableView {
  readonly root = make("div", "rw-message-table");
  readonly #table = make("table", "");
  readonly #note = make("p", "rw-message-note");
  readonly #rows: TableRowView[] = [];
  #key = "";

  constructor() {
    this.root.append(this.#table, this.#note);
  }

  /** @param isChanged returns true if the field of a row has changed @param isOpen returns true if a row is unfolded */
  update(table: Table, isChanged: (key: string) => boolean, isOpen: (key: string) => boolean): void {
    const columns = table.rows[0]?.cells.length ?? 1;
    const key = `${table.kind} ${table.rows.length} ${columns}`;
    if (key !== this.#key) this.#build(table, columns);
    this.#key = key;
    for (const [i, row] of table.rows.entries()) {
      const view = this.#rows[i];
      if (!view) continue;
      set(view.root.dataset, "rwRow", row.key);
      view.update(row, isChanged(row.key), isOpen(row.key));
    }
    setText(this.#note, table.note);
  }

  #build({ kind, heads, rows }: Table, columns: number): void {
    this.root.className = `rw-message-table rw-message-${kind}`;
    this.#rows.splice(0, this.#rows.length, ...rows.map(() => new TableRowView(columns)));
    const head = make("thead", "");
    if (heads.length) {
      const line = make("tr", "");
      line.append(make("th", "rw-message-name", "name"));
      for (const { name, unit } of heads) {
        const cell = make("th", "rw-message-head");
        cell.append(make("b", "", name), make("span", "rw-message-unit", unit));
        line.append(cell);
      }
      head.append(line);
    }
    const body = make("tbody", "");
    body.append(...this.#rows.flatMap(({ root, inner }) => [root, inner]));
    this.#table.replaceChildren(head, body);
  }
}
