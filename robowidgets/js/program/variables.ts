import { make, setHidden, setText } from "../shared/dom.ts";
import { on } from "../shared/events.ts";
import { toStep, toValue } from "./text.ts";
import type { Variable } from "./traits.ts";

/** Milliseconds for which a value that was set here is not overwritten by an older one from Python. */
const ECHO_MS = 500;

/** The rows of the variables: a slider, a switch, a number, or a text. */
export class VariableRows {
  readonly root = make("div", "rw-variables rw-pale");
  readonly #rows = new Map<string, Row>();
  readonly #set: (name: string, value: number | boolean) => void;
  readonly #signal: AbortSignal;

  constructor(set: (name: string, value: number | boolean) => void, signal: AbortSignal) {
    this.#set = set;
    this.#signal = signal;
  }

  update(variables: Variable[]): void {
    setHidden(this.root, variables.length === 0);
    for (const variable of variables) {
      const kind = kindOf(variable);
      const known = this.#rows.get(variable.name);
      if (known?.kind !== kind) {
        const row = new Row(variable, kind, (value) => this.#set(variable.name, value), this.#signal);
        if (known) known.root.replaceWith(row.root);
        else this.root.append(row.root);
        this.#rows.set(variable.name, row);
      }
      this.#rows.get(variable.name)?.update(variable);
    }
    const names = new Set(variables.map(({ name }) => name));
    for (const [name, row] of this.#rows) {
      if (names.has(name)) continue;
      row.root.remove();
      this.#rows.delete(name);
    }
  }

  /** Cancels a drag. */
  cancel(): void {
    for (const row of this.#rows.values()) row.cancel();
  }
}

type Kind = "range" | "checkbox" | "number" | "text";

function kindOf({ value, low }: Variable): Kind {
  if (typeof value === "boolean") return "checkbox";
  if (typeof value === "string") return "text";
  return low === null ? "number" : "range";
}

class Row {
  readonly root = make("label", "rw-variable");
  readonly kind: Kind;
  readonly #input = make("input", "");
  readonly #value = make("b", "rw-variable-value");
  readonly #unit = make("span", "rw-variable-unit");
  readonly #tick = make("i", "rw-variable-tick");
  readonly #set: (value: number | boolean) => void;
  #setAt = Number.NEGATIVE_INFINITY;
  #before: number | null = null;

  constructor({ name }: Variable, kind: Kind, set: (value: number | boolean) => void, signal: AbortSignal) {
    this.kind = kind;
    this.#set = set;
    this.#input.type = kind;
    this.#input.ariaLabel = name;
    this.#input.className = kind === "range" ? "rw-slider" : `rw-variable-field${kind === "number" ? " rw-field" : ""}`;
    if (kind === "checkbox") this.#input.role = "switch";
    const track = make("span", "rw-variable-track");
    track.append(this.#tick, this.#input);
    setHidden(this.#tick, kind !== "range");
    const value = make("span", "rw-variable-number");
    value.append(this.#value, " ", this.#unit);
    const label = make("code", "rw-variable-name", name);
    this.root.dataset.kind = kind;
    this.root.append(label, value);
    if (kind !== "text") this.root.append(track);
    const input = this.#input;
    if (kind === "range") {
      on(input, "pointerdown", () => (this.#before = input.valueAsNumber), signal);
      for (const type of ["pointerup", "pointercancel"] as const) on(input, type, () => (this.#before = null), signal);
    }
    on(input, kind === "number" ? "change" : "input", () => this.#send(), signal);
    on(input, "keydown", (event) => event.key !== "Escape" && event.stopPropagation(), signal);
  }

  update(variable: Variable): void {
    const { value, before, low, high, unit, whole } = variable;
    if (performance.now() - this.#setAt < ECHO_MS || (this.kind === "number" && this.#input.matches(":focus"))) {
      return;
    }
    setText(this.#value, toValue(variable));
    setText(this.#unit, unit);
    if (low !== null && high !== null) {
      Object.assign(this.#input, { min: String(low), max: String(high), step: String(toStep(low, high, whole)) });
      const share = Math.min(Math.max((Number(before) - low) / (high - low), 0), 1);
      this.#tick.style.left = `calc(5px + ${share} * (100% - 12px))`; // the middle of the handle, which is 12 px wide
    }
    if (typeof value === "boolean") this.#input.checked = value;
    else this.#input.value = String(value);
  }

  cancel(): void {
    if (this.#before === null) return;
    this.#input.value = String(this.#before);
    this.#before = null;
    this.#input.blur();
    this.#send();
  }

  #send(): void {
    this.#setAt = performance.now();
    const input = this.#input;
    const value = this.kind === "checkbox" ? input.checked : input.valueAsNumber;
    if (Number.isNaN(value)) {
      input.value = this.#value.textContent; // an empty field
      return;
    }
    setText(this.#value, String(value));
    this.#set(value);
  }
}
