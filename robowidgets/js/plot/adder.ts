import { make, makeButton, setHidden } from "../shared/dom.ts";
import { on } from "../shared/events.ts";

/** Greatest number of choices in the list; typed words filter it. */
const MOST = 50;

/** A button that unfolds a list of fields, each of which becomes a line. */
export class Adder {
  readonly button: HTMLButtonElement;
  readonly panel = make("div", "rw-plot-adder");
  readonly #input = make("input", "rw-field rw-plot-find");
  readonly #list = make("div", "rw-plot-choices");
  readonly #add: (name: string) => void;
  readonly #signal: AbortSignal;
  #choices: string[] = [];
  #taken: string[] = [];

  constructor(add: (name: string) => void, signal: AbortSignal) {
    this.#add = add;
    this.#signal = signal;
    this.button = makeButton("rw-plot-add", "Add a line", () => this.#toggle(), signal, "Add a line");
    this.button.ariaExpanded = "false";
    this.panel.hidden = true;
    this.#input.type = "search";
    this.#input.placeholder = "words of a topic or field";
    this.#input.ariaLabel = "find a field";
    this.#list.role = "list";
    this.panel.append(this.#input, this.#list);
    on(this.#input, "input", () => this.#fill(), signal);
    on(this.panel, "keydown", (event) => this.#onKey(event), signal);
  }

  /**
   * @param choices fields that can become lines
   * @param taken fields that are lines
   */
  update(choices: string[], taken: string[]): void {
    setHidden(this.button, !choices.length);
    if (choices === this.#choices && taken.join() === this.#taken.join()) return;
    this.#choices = choices;
    this.#taken = taken;
    if (!this.panel.hidden) this.#fill();
  }

  #toggle(isOpen = this.panel.hidden): void {
    this.panel.hidden = !isOpen;
    this.button.ariaExpanded = String(isOpen);
    if (!isOpen) return;
    this.#fill();
    this.#input.focus();
  }

  #fill(): void {
    const words = this.#input.value.toLowerCase().split(/\s+/);
    const fits = (name: string) => words.every((word) => name.toLowerCase().includes(word));
    const found = this.#choices.filter((name) => !this.#taken.includes(name) && fits(name));
    const rows = found.slice(0, MOST).map((name) => {
      const choose = () => {
        this.#add(name);
        this.#toggle(false);
        this.button.focus();
      };
      const button = makeButton("rw-plot-choice", `Add ${name}`, choose, this.#signal, name);
      return button;
    });
    const more = found.length > MOST ? `and ${found.length - MOST} more: type words of a name` : "";
    this.#list.replaceChildren(...rows, make("div", "rw-plot-note", more || (rows.length ? "" : "no such field")));
  }

  #onKey(event: KeyboardEvent): void {
    event.stopPropagation(); // the keys of the picture are letters, too
    if (event.key === "Escape") {
      this.#toggle(false);
      this.button.focus();
      return;
    }
    const buttons = [...this.#list.querySelectorAll("button")];
    const at = buttons.indexOf(document.activeElement as HTMLButtonElement);
    const step = event.key === "ArrowDown" ? 1 : event.key === "ArrowUp" ? -1 : 0;
    if (step) {
      event.preventDefault();
      const next = at + step;
      if (next < 0) this.#input.focus();
      else buttons[Math.min(next, buttons.length - 1)]?.focus();
    } else if (event.key === "Enter" && at < 0) {
      event.preventDefault(); // the button that has the focus then is not pressed by the same key
      buttons[0]?.click();
    }
  }
}
