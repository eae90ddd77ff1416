import { make, set } from "../shared/dom.ts";
import { on } from "../shared/events.ts";
import { toFixed } from "../shared/format.ts";
import { toWords } from "../shared/states/states.ts";
import type { Fired } from "./traits.ts";

const STEPS: Record<string, number> = { ArrowDown: 1, ArrowUp: -1 };

/** The moves that were made, the newest first. Arrow keys walk the entries; a click shows the moment of one. */
export class Entries {
  readonly root = make("div", "rw-fired");
  readonly #show: (fired: Fired) => void;
  readonly #signal: AbortSignal;
  #rows = new Map<string, HTMLButtonElement>();

  constructor(show: (fired: Fired) => void, signal: AbortSignal) {
    this.#show = show;
    this.#signal = signal;
    this.root.role = "group";
    this.root.ariaLabel = "what fired";
    on(this.root, "keydown", (event) => this.#onKey(event), signal);
  }

  /** @param shown time of arrival of the frozen picture, or null while it is live */
  update(fired: Fired[], shown: number | null): void {
    // Entries below the pointer do not move before a click.
    if (!this.root.matches(":hover")) this.#list(fired);
    const current = shown === null ? undefined : fired.filter(({ at }) => at <= shown).at(-1);
    const rows = [...this.#rows.values()];
    const focus = rows.find((row) => row.matches(":focus")) ?? rows[0];
    for (const [key, row] of this.#rows) {
      set(row, "ariaCurrent", String(current !== undefined && key === keyOf(current)));
      set(row, "tabIndex", row === focus ? 0 : -1);
    }
  }

  #list(fired: Fired[]): void {
    const before = this.#rows;
    this.#rows = new Map([...fired].reverse().map((one) => [keyOf(one), before.get(keyOf(one)) ?? this.#makeRow(one)]));
    for (const [key, row] of before) if (!this.#rows.has(key)) row.remove();
    // New rows are put before those that stay, so that none of them loses the focus.
    let next = this.root.firstChild;
    for (const row of this.#rows.values()) {
      if (row === next) next = row.nextSibling;
      else this.root.insertBefore(row, next);
    }
  }

  #makeRow(fired: Fired): HTMLButtonElement {
    const row = make("button", "rw-fired-row");
    row.type = "button";
    const words = make("span", "rw-fired-words");
    const said = make("span", "rw-fired-said");
    said.append(make("span", "rw-fired-why", fired.why.replace(/^on /, "")), make("span", "", fired.reading));
    words.append(said, make("span", "rw-index", fired.index === null ? "" : `[${fired.index}]`));
    const way = make("b", "rw-fired-way", `${fired.source} \u2192 ${fired.target}`);
    row.append(make("span", "rw-fired-time", toFixed(fired.time, 2)), way, words);
    row.title = `${toWords(fired.machine)}: ${way.textContent}\n${fired.why} ${fired.reading}\nShow this moment`;
    on(row, "click", () => this.#show(fired), this.#signal);
    return row;
  }

  #onKey(event: KeyboardEvent): void {
    const rows = [...this.#rows.values()];
    const next = rows[rows.indexOf(event.target as HTMLButtonElement) + (STEPS[event.key] ?? 0)];
    // A button takes these keys itself.
    if (/^(Enter| )$/.test(event.key)) event.stopPropagation();
    if (!STEPS[event.key] || !next) return;
    event.preventDefault();
    next.focus();
    next.tabIndex = 0;
  }
}

function keyOf({ at, machine, source, target }: Fired): string {
  return `${at} ${machine} ${source} ${target}`;
}
