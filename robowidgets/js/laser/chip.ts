import type { Point, Size } from "../shared/box.ts";
import { CopyCode } from "../shared/copy.ts";
import { make, makeButton, set, setHidden, setText } from "../shared/dom.ts";
import { on } from "../shared/events.ts";
import { LaidOut } from "../shared/laid_out.ts";
import { ABOUT_FORMS, FORMS, type Form } from "./code.ts";

/** The texts of a chip. */
export interface ChipTexts {
  expression: string;
  angles: string;
  /** State of its limits. */
  state: string;
  distance: string;
  nearest: string;
  index: string;
  median: string;
  valid: string;
  /** Name of a kept sector; "" for another one. */
  name: string;
}

/** Actions of the user on the chip. */
interface ChipActions {
  toCode(form: Form): string;
  say(words: string[]): void;
  /** Returns an error text, or "". */
  onName(name: string): string;
  onRemove(): void;
  onClose(): void;
  /** Returns an error text, or "". */
  onType(text: string): string;
}

const LONGEST_NAME = 40;
/** Its size before it is laid out, and the least that it takes with all its rows. Pixels. */
const USUAL = { width: 266, height: 131 };

/** The numbers of the picked sector, its code and its name; without one, a field in which its rays are typed. */
export class Chip {
  readonly element = make("div", "rw-floating rw-chip rw-over");
  readonly #size: LaidOut;
  readonly #expression = makeField("rw-chip-expression", "rays as a slice, such as ranges[240:300]");
  readonly #error = make("div", "rw-chip-error");
  readonly #texts: HTMLElement[] = [];
  readonly #copy: CopyCode<Form>;
  readonly #name: HTMLButtonElement;
  readonly #remove: HTMLButtonElement;
  readonly #naming = make("div", "rw-chip-row rw-chip-actions");
  readonly #nameField = makeField("rw-chip-name", "name of the sector");
  readonly #picture: HTMLElement;
  readonly #signal: AbortSignal;
  #given = "";
  #kept = "";

  /** @param onResize called when it has another size */
  constructor(picture: HTMLElement, actions: ChipActions, onResize: () => void, signal: AbortSignal) {
    this.#size = new LaidOut(onResize, signal, USUAL).of(this.element);
    this.#picture = picture;
    this.#signal = signal;
    this.#expression.placeholder = "ranges[240:300]";
    this.#error.role = "alert";
    const rows = [
      ["rw-chip-angles", "rw-strong"],
      ["rw-chip-distance", "rw-chip-nearest", "rw-index"],
      ["rw-chip-median", "rw-chip-valid"],
    ];
    const close = makeButton("rw-chip-close", "Deselect (Escape)", actions.onClose, signal, "\u00D7");
    const top = make("div", "rw-chip-row");
    top.append(this.#expression, close);
    this.element.append(top, this.#error);
    for (const names of rows) {
      const row = make("div", "rw-chip-row");
      row.append(...names.map((name) => make("span", name)));
      this.#texts.push(...(row.children as Iterable<HTMLElement>));
      this.element.append(row);
    }
    this.#copy = new CopyCode(actions.toCode, actions.say, signal, FORMS, ABOUT_FORMS);
    this.#name = makeButton("", "Keep it under a name (Enter)", () => this.askName(), signal, "Name");
    this.#remove = makeButton("", "Remove it (Delete)", actions.onRemove, signal, "Remove");
    this.#copy.row.append(this.#name, this.#remove);
    const keep = () => {
      const name = this.#nameField.value.trim();
      const error = name && actions.onName(name);
      if (error) setText(this.#error, error);
      else this.#endNaming();
    };
    this.#naming.append(this.#nameField, makeButton("", "Keep it", keep, signal, "Keep"));
    this.#nameField.maxLength = LONGEST_NAME;
    this.#naming.hidden = true;
    this.element.append(this.#copy.row, this.#naming, this.#copy.field);
    // Keys in a field are for it alone; keys on buttons are for the picture, too.
    const keepKeys = (event: KeyboardEvent) => {
      if (!(event.target instanceof HTMLButtonElement)) event.stopPropagation();
    };
    on(this.element, "keydown", keepKeys, signal);
    onEnter(this.#nameField, keep, () => this.#endNaming(), signal);
    const type = () => {
      const error = this.#expression.value === this.#given ? "" : actions.onType(this.#expression.value);
      setText(this.#error, error);
      if (!error) this.#leave(this.#expression);
    };
    const undo = () => {
      setText(this.#error, "");
      this.#leave(this.#expression);
    };
    const leave = () => {
      undo();
      if (!this.#given) actions.onClose();
    };
    onEnter(this.#expression, type, leave, signal);
    // A field that is left without Enter shows its old text again.
    on(this.#expression, "blur", undo, signal);
  }

  /** Size of the chip while a sector is picked. */
  get size(): Size {
    return { width: this.#size.width, height: Math.max(USUAL.height, this.#size.height) };
  }

  /**
   * @param texts null without a sector
   * @param isBelow true if it stands below the picture, not in it
   */
  show(texts: ChipTexts | null, isBelow: boolean): void {
    if (this.element.parentElement === null || this.element.classList.contains("rw-chip-below") !== isBelow) {
      this.element.classList.toggle("rw-chip-below", isBelow);
      this.element.style.transform = "";
      if (isBelow) this.#picture.after(this.element);
      else this.#picture.append(this.element);
    }
    set(this.element, "ariaLabel", `sector ${texts?.name ?? ""}`.trim());
    this.element.classList.toggle("rw-chip-empty", !texts);
    this.#given = texts?.expression ?? "";
    if (!this.#expression.matches(":focus")) this.#write();
    if (!texts) return;
    const { angles, state, distance, nearest, index, median, valid } = texts;
    for (const [i, text] of [angles, state, distance, nearest, index, median, valid].entries()) {
      setText(this.#texts[i] as HTMLElement, text);
    }
    if (this.#kept !== texts.name) this.#endNaming();
    this.#kept = texts.name;
    setText(this.#name, texts.name ? "Rename" : "Name");
    setHidden(this.#remove, !texts.name);
  }

  place({ x, y }: Point): void {
    this.element.style.transform = `translate(${Math.round(x)}px, ${Math.round(y)}px)`;
  }

  hide(): void {
    if (!this.element.parentElement) return;
    this.#copy.reset();
    this.#endNaming();
    setText(this.#error, "");
    this.element.remove();
  }

  /** Asks for a name in a text field. */
  askName(proposal = this.#kept): void {
    this.#copy.row.hidden = true;
    this.#naming.hidden = false;
    this.#nameField.value = proposal;
    this.#nameField.focus({ preventScroll: true });
    this.#nameField.select();
  }

  /** Asks for rays in the text field. */
  askRays(): void {
    this.#expression.focus({ preventScroll: true });
    this.#expression.select();
  }

  copy(): void {
    this.#copy.copy();
  }

  #write(): void {
    // The attribute is for the PNG, the value for a field in which the user has typed.
    if (this.#expression.getAttribute("value") !== this.#given) this.#expression.setAttribute("value", this.#given);
    if (this.#expression.value !== this.#given) this.#expression.value = this.#given;
    this.#expression.size = Math.max(8, Math.min(26, this.#given.length));
  }

  #endNaming(): void {
    if (this.#naming.hidden) return;
    setText(this.#error, "");
    this.#naming.hidden = true;
    this.#copy.row.hidden = false;
    this.#leave(this.#nameField);
  }

  /** Gives the focus of a field back to the picture, whose keys then work. */
  #leave(field: HTMLElement): void {
    this.#write();
    if (field.matches(":focus") && !this.#signal.aborted) this.#picture.focus({ preventScroll: true });
  }
}

function makeField(className: string, label: string): HTMLInputElement {
  const field = make("input", className);
  field.type = "text";
  field.spellcheck = false;
  field.autocomplete = "off";
  field.ariaLabel = label;
  field.title = label;
  return field;
}

/** Handles Enter and Escape in a text field. */
function onEnter(field: HTMLElement, enter: () => void, leave: () => void, signal: AbortSignal): void {
  const onKey = (event: KeyboardEvent) => {
    if (event.key !== "Enter" && event.key !== "Escape") return;
    event.preventDefault();
    if (event.key === "Enter") enter();
    else leave();
  };
  on(field, "keydown", onKey, signal);
}
