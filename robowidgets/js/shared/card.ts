import { make, mount, setText } from "./dom.ts";
import { keepKeys } from "./keys.ts";
import { type Model, onChange } from "./model.ts";
import { Notice } from "./notice.ts";
import { applyTheme, type Theme, watchTheme } from "./theme.ts";
import type { CardTraits, Problem } from "./traits.ts";

/** The frame around a picture: title and controls above, a notice over it, a footer below. */
export class Card {
  readonly root: HTMLElement;
  readonly header = make("div", "rw-header");
  readonly controls = make("span", "rw-controls");
  readonly picture = make("div", "rw-picture");
  readonly footer = make("div", "rw-footer");
  readonly #title = make("span", "rw-title");
  readonly #facts = make("span", "rw-facts");
  readonly #notice: Notice;
  readonly #live = make("div", "rw-live rw-unseen");
  readonly #kind: string;
  readonly #model: Model<CardTraits>;
  #theme: Theme | null = null;

  /**
   * @param kind name of the widget, for its CSS class and its label: "laser", "speed", "touch"
   * @param redraw draws the picture anew; called when the theme has changed
   */
  constructor(element: HTMLElement, kind: string, model: Model<CardTraits>, redraw: () => void, signal: AbortSignal) {
    this.#model = model;
    this.#kind = kind;
    this.root = make("div", `rw-card rw-${kind}`);
    this.root.role = "group";
    this.picture.tabIndex = 0;
    this.picture.role = "group";
    this.picture.ariaLabel = "picture";
    this.#live.ariaLive = "polite";
    this.header.append(this.#title, this.#facts, this.controls);
    this.#notice = new Notice(signal);
    this.picture.append(this.#notice.element);
    this.root.append(this.header, this.picture, this.footer, this.#live);
    mount(element, this.root, signal);
    const onTheme = () => {
      this.#theme = null;
      redraw();
    };
    watchTheme(onTheme, signal);
    onChange(model, ["title", "header", "footer"], redraw, signal);
    keepKeys(this.root, signal);
  }

  /** Colours and fonts. Read it while drawing: an element outside the page has no computed style. */
  get theme(): Theme {
    this.#theme ??= applyTheme(this.root);
    return this.#theme;
  }

  /** Height of the notice at the top of the picture, in pixels. */
  get noticeHeight(): number {
    return this.#notice.height;
  }

  /**
   * Brings header, notice and footer up to date.
   * @param problems those in the data, after the lines
   * @param kind of the notice: a note, an error, or the status of a feed
   */
  updateFrame(lines: string[], kind: "note" | "error" | "status", problems: readonly Problem[] = []): void {
    this.#theme ??= applyTheme(this.root);
    this.header.hidden = !this.#model.get("header");
    this.footer.hidden = !this.#model.get("footer");
    const title = this.#model.get("title");
    setText(this.#title, title);
    this.root.ariaLabel = `${this.#kind} ${title}`.trim();
    this.#notice.update(lines, problems, kind);
  }

  /** Has a screen reader say words about what keys have moved to. */
  say(words: string[]): void {
    setText(this.#live, words.filter(Boolean).join(", "));
  }

  /** Shows facts after the title; all of them in one line. */
  updateFacts(facts: string[]): void {
    setText(this.#facts, facts.join(" ·\u00A0"));
  }

  /** The facts as they are shown. */
  get facts(): string {
    return this.#facts.textContent;
  }
}
