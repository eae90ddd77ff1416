import { make, makeButton, setHidden, setText } from "./dom.ts";
import { on } from "./events.ts";

/** Callbacks for a name that the user types. */
interface Naming {
  onName(name: string): void;
  onRemove(): void;
}

/** A row in which the user names something: Enter keeps the name, Escape leaves it, and a button removes it. */
export class NameRow {
  readonly root = make("span", "rw-naming");
  readonly #about = make("span", "rw-naming-about");
  readonly #field = make("input", "rw-field");
  readonly #known = make("datalist", "");
  readonly #remove: HTMLButtonElement;
  /** Elements that are in the page while the row is open. */
  readonly #parts: HTMLElement[];
  readonly #naming: Naming;
  /** The name that was given last, which is offered next. */
  #last = "";
  #focused: Element | null = null;

  /** @param label of the field, for screen readers */
  constructor(label: string, naming: Naming, signal: AbortSignal) {
    this.#naming = naming;
    this.#field.placeholder = "name, then Enter";
    this.#field.ariaLabel = label;
    this.#field.maxLength = 200;
    this.#known.id = `rw-names-${Math.random().toString(36).slice(2)}`;
    this.#field.setAttribute("list", this.#known.id);
    const keep = makeButton("", "Keep this name (Enter)", () => this.#keep(), signal, "Keep");
    this.#remove = makeButton("", "Take the name away", () => this.#leave(() => naming.onRemove()), signal, "Remove");
    const close = makeButton("rw-naming-close", "Leave it as it is (Escape)", () => this.close(), signal, "\u00d7");
    for (const button of [keep, this.#remove]) button.ariaLabel = null;
    this.#parts = [this.#about, this.#field, this.#known, keep, this.#remove, close];
    this.root.hidden = true;
    on(this.root, "keydown", (event) => this.#onKey(event), signal);
  }

  get isOpen(): boolean {
    return !this.root.hidden;
  }

  /**
   * Asks for a name.
   *
   * @param about the thing to name, or an error in its name
   * @param name its present name, or ""
   * @param known names of other things
   */
  open(about: string, name: string, known: Iterable<string>, typed = name): void {
    if (!this.isOpen) this.#focused = document.activeElement;
    setText(this.#about, about);
    setHidden(this.#remove, !name);
    this.#known.replaceChildren(...[...new Set(known)].sort().map((one) => new Option("", one)));
    if (!this.isOpen) this.root.append(...this.#parts);
    setHidden(this.root, false);
    this.#field.value = typed || this.#last;
    this.#field.focus();
    this.#field.select();
  }

  close(): void {
    this.#leave(() => {});
  }

  #keep(): void {
    const name = this.#field.value.trim().replace(/\s+/g, " ");
    if (!name) {
      this.#field.focus();
      return;
    }
    this.#last = name;
    this.#leave(() => this.#naming.onName(name));
  }

  #leave(then: () => void): void {
    setHidden(this.root, true);
    this.root.replaceChildren();
    if (this.#focused instanceof HTMLElement) this.#focused.focus({ preventScroll: true });
    then();
  }

  #onKey(event: KeyboardEvent): void {
    event.stopPropagation();
    if (event.key === "Escape") this.close();
    else if (event.key === "Enter" && event.target === this.#field) this.#keep();
    else return;
    event.preventDefault();
  }
}
