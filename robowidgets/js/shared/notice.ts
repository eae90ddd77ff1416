import { make, makeButton, set, setHidden, setText } from "./dom.ts";
import { on } from "./events.ts";
import { asSentence } from "./format.ts";
import { LaidOut } from "./laid_out.ts";
import type { Problem } from "./traits.ts";

/** Pixels of one line. */
const LINE = 26;

/** A line on top of a picture, which unfolds to the problems in it and their remedies. */
export class Notice {
  readonly element = make("div", "rw-notice rw-over");
  readonly #text = make("span", "rw-notice-text");
  readonly #more: HTMLButtonElement;
  readonly #remedies = make("div", "rw-remedies");
  readonly #size: LaidOut;
  #problems = "[]";
  #isOpen = false;

  /** @param onResize called when it has another height */
  constructor(onResize: () => void, signal: AbortSignal) {
    this.#size = new LaidOut(onResize, signal, { width: 0, height: LINE }).of(this.element);
    this.#text.role = "status";
    this.#more = makeButton(
      "rw-unfold rw-more",
      "Show or hide the remedies",
      () => this.#unfold(!this.#isOpen),
      signal,
      "What to do",
    );
    this.#more.ariaLabel = null;
    this.element.append(this.#text, this.#more, this.#remedies);
    this.#unfold(false);
    this.element.hidden = true;
    // Escape folds it, and does not reach the pinned ray.
    const onKey = (event: KeyboardEvent) => {
      if (event.key !== "Escape" || !this.#isOpen) return;
      event.stopPropagation();
      this.#unfold(false);
    };
    on(this.element, "keydown", onKey, signal);
  }

  /** Pixels that it covers. The remedies lie over the picture, so that nothing moves when they unfold. */
  get height(): number {
    return this.element.hidden ? 0 : this.#size.height;
  }

  update(lines: string[], problems: readonly Problem[], kind: "note" | "error" | "status"): void {
    const all = [...lines, ...problems.map(([what]) => what)];
    setHidden(this.element, !all.length);
    this.#text.classList.toggle("rw-error", kind === "error");
    this.#text.classList.toggle("rw-status", kind === "status");
    setText(this.#text, all.join(" · "));
    set(this.#text, "title", all.join("\n"));
    setHidden(this.#more, !problems.some(([, remedy]) => remedy));
    const key = JSON.stringify(problems);
    if (key === this.#problems) return;
    this.#problems = key;
    if (this.#more.hidden) this.#unfold(false);
    const words = problems.flatMap(([what, remedy]) => [make("b", "", what), make("span", "", asSentence(remedy))]);
    this.#remedies.replaceChildren(...words);
  }

  #unfold(isOpen: boolean): void {
    this.#isOpen = isOpen;
    set(this.#more, "ariaExpanded", String(isOpen));
    setHidden(this.#remedies, !isOpen);
  }
}
