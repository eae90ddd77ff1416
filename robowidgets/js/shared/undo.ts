import { on } from "./events.ts";

/** A change of the user: what it is in words, and a function that undoes it. */
export interface Change {
  words: string;
  undo(): void;
  /** Returns true if it was refused, so that nothing is left to undo. */
  isRefused?(): boolean;
}

const CHANGED = "rw-changed";
const MOST = 200;
const FIELDS = "input:not([type=range]), textarea, select, [contenteditable]";

/** Keeps a change for Ctrl+Z, in the outermost screen or card around an element. */
export function keepChange(at: Element, change: Change): void {
  at.dispatchEvent(new CustomEvent(CHANGED, { detail: change, bubbles: true }));
}

/** Returns true if an element takes text: its keys are for it alone. */
export function isField(target: EventTarget | null): boolean {
  return target instanceof Element && target.matches(FIELDS);
}

/** Returns true for Ctrl+Z, except in a field, whose own text it undoes. */
export function isUndo({ key, ctrlKey, metaKey, shiftKey, target }: KeyboardEvent): boolean {
  return key === "z" && (ctrlKey || metaKey) && !shiftKey && !isField(target);
}

/** The changes of the user within an element, except those within an element of `Changes` around it. */
export class Changes {
  readonly #kept: Change[] = [];

  constructor(root: HTMLElement, signal: AbortSignal) {
    const keep = (event: Event) => {
      // On the way in, so that the outermost element has it.
      event.stopPropagation();
      this.#kept.push((event as CustomEvent<Change>).detail);
      if (this.#kept.length > MOST) this.#kept.shift();
    };
    root.addEventListener(CHANGED, keep, { capture: true, signal });
  }

  /** Undoes the last change, and returns its words; "" without a change. */
  undo(): string {
    let change = this.#kept.pop();
    while (change?.isRefused?.()) change = this.#kept.pop();
    change?.undo();
    return change ? `back: ${change.words}` : "";
  }
}

/**
 * Undoes the changes within an element by Ctrl+Z.
 * @param say announces what was undone
 */
export function watchUndo(root: HTMLElement, say: (words: string) => void, signal: AbortSignal): void {
  const changes = new Changes(root, signal);
  const onKey = (event: KeyboardEvent) => {
    const words = !event.defaultPrevented && isUndo(event) ? changes.undo() : "";
    if (!words) return;
    event.preventDefault();
    event.stopPropagation();
    say(words);
  };
  on(root, "keydown", onKey, signal);
}
