import { on } from "./events.ts";

/** The order of the work before a page is printed: colours, which drawings use, then sizes, then the drawings. */
const PHASES = ["colours", "sizes", "drawings"] as const;

type Phase = (typeof PHASES)[number];

const CLASS = "rw-printing";

/**
 * The print of the page. A browser prints without another animation frame: all that a print changes is drawn at once,
 * before it begins and while it lays out the paper.
 */
class Print {
  readonly #calls: Record<Phase, Set<() => void>> = { colours: new Set(), sizes: new Set(), drawings: new Set() };

  constructor() {
    const paper = matchMedia("print");
    on(window, "beforeprint", () => this.#set(true), new AbortController().signal);
    on(window, "afterprint", () => this.#set(false), new AbortController().signal);
    on(paper, "change", () => this.#set(paper.matches), new AbortController().signal);
    this.#set(paper.matches);
  }

  get isOn(): boolean {
    return document.documentElement.classList.contains(CLASS);
  }

  add(phase: Phase, call: () => void): () => void {
    this.#calls[phase].add(call);
    return () => this.#calls[phase].delete(call);
  }

  #set(isOn: boolean): void {
    if (isOn === this.isOn) return;
    document.documentElement.classList.toggle(CLASS, isOn);
    for (const phase of PHASES) for (const call of [...this.#calls[phase]]) call();
  }
}

const KEY: unique symbol = Symbol.for("robowidgets print") as never;

/** The scripts of different widgets share only this object. */
const page = globalThis as { [KEY]?: Print };

/** Returns true while the page is printed. */
export function isPrinting(): boolean {
  return page[KEY]?.isOn ?? false;
}

/** Calls before and after the page is printed; returns a function that ends this. Without a page it does nothing. */
export function onPrint(phase: Phase, call: () => void): () => void {
  if (typeof document === "undefined") return () => {};
  page[KEY] ??= new Print();
  return page[KEY].add(phase, call);
}
