import { type Surface, sizeOf, watchSize } from "./canvas.ts";
import { make, mount, set, setHidden, setName, setText } from "./dom.ts";
import { onAbort } from "./events.ts";
import { keepKeys } from "./keys.ts";
import { LaidOut } from "./laid_out.ts";
import { type Model, onChange } from "./model.ts";
import { Notice } from "./notice.ts";
import { afterDrawings, perAnimationFrame, Texts, throttle } from "./schedule.ts";
import { followTheme, type Theme } from "./theme.ts";
import type { CardTraits, Problem } from "./traits.ts";
import { watchUndo } from "./undo.ts";

const BORDER = 1;
/** Milliseconds between two drawings of a card that is scrolled out of sight, so that its texts can be found. */
const UNSEEN_MS = 500;

/**
 * The frame around a picture: title and controls above, a notice over it, a footer below. It schedules the drawings of
 * the picture.
 */
export class Card {
  readonly root: HTMLElement;
  readonly header = make("div", "rw-header");
  readonly controls = make("span", "rw-controls");
  readonly picture = make("div", "rw-picture");
  readonly footer = make("div", "rw-footer");
  /** Draws the picture again in the next animation frame. */
  readonly redraw: () => void;
  readonly texts: Texts;
  /** Size of the picture. */
  size: Surface = { width: 0, height: 0, ratio: 1 };
  readonly #outer: LaidOut;
  readonly #title = make("span", "rw-title");
  readonly #facts = make("span", "rw-facts");
  readonly #notice: Notice;
  readonly #silence = make("div", "rw-silence");
  readonly #live = make("div", "rw-live rw-unseen");
  readonly #kind: string;
  readonly #model: Model<CardTraits>;
  readonly #draw: () => void;
  readonly #theme: () => Theme;
  /** True while some of it is in view. */
  #isSeen = true;

  /**
   * @param kind name of the widget, for its CSS class and its label: "laser", "speed", "touch"
   * @param draw draws the picture, as soon as it has a size: for another size now, else in an animation frame. It
   * paints
   * first, and then updates the elements: to paint text, a browser first lays out the changed elements again
   */
  constructor(element: HTMLElement, kind: string, model: Model<CardTraits>, draw: () => void, signal: AbortSignal) {
    this.#model = model;
    this.#kind = kind;
    this.#draw = draw;
    this.texts = new Texts(signal);
    // The user drives by the laser: it waits for no other card.
    const soon = perAnimationFrame(() => this.#drawAll(false), signal, kind === "laser");
    const late = throttle(soon, UNSEEN_MS, signal);
    this.redraw = () => (this.#isSeen ? soon : late)();
    this.root = make("div", `rw-card rw-${kind}`);
    this.root.role = "group";
    this.picture.tabIndex = 0;
    this.picture.role = "group";
    this.picture.ariaLabel = "picture";
    this.#live.ariaLive = "polite";
    this.header.append(this.#title, this.#facts, this.controls);
    this.#notice = new Notice(this.redraw, signal);
    this.picture.append(this.#notice.element, this.#silence);
    this.root.append(this.header, this.picture, this.footer, this.#live);
    mount(element, this.root, signal);
    this.#theme = followTheme(this.root, model, signal, () => this.#onTheme());
    // Before the picture: it may be drawn for this width.
    this.#outer = new LaidOut(() => {}, signal).of(this.root);
    watchSize(
      this.picture,
      (size) => this.#drawFor(size),
      signal,
      () => this.theme,
    );
    onChange(model, ["title", "header", "footer"], this.redraw, signal);
    keepKeys(this.root, signal);
    watchUndo(this.root, (words) => this.say([words]), signal);
    const observer = new IntersectionObserver((entries) => {
      const wasSeen = this.#isSeen;
      this.#isSeen = entries.at(-1)?.isIntersecting !== false;
      if (this.#isSeen && !wasSeen) soon();
    });
    observer.observe(this.root);
    onAbort(signal, () => observer.disconnect());
  }

  /** Draws the picture at once, at a pixel ratio or the screen's. */
  drawNow(ratio?: number): void {
    this.#drawFor(sizeOf(this.picture, ratio));
  }

  /** A look may change the scale of the picture and nothing else of its size. */
  #onTheme(): void {
    if (this.size.width) this.size = sizeOf(this.picture);
    this.redraw();
  }

  #drawFor(size: Surface): void {
    this.size = size;
    this.#drawAll(true);
  }

  #drawAll(isNow: boolean): void {
    if (!this.size.width) return;
    const { noticeHeight } = this;
    this.#draw();
    if (this.noticeHeight !== noticeHeight) this.#draw();
    if (isNow) this.texts.write(true);
    else afterDrawings(() => this.texts.write(false));
  }

  /** Colours and fonts. Read it while drawing: an element outside the page has no computed style. */
  get theme(): Theme {
    return this.#theme();
  }

  /** Pixels within its borders, with everything at the sides of the picture. */
  get width(): number {
    return this.#outer.width - 2 * BORDER;
  }

  /** Height of the notice at the top of the picture, in pixels. */
  get noticeHeight(): number {
    return this.#notice.height;
  }

  /**
   * Updates header, notice and footer.
   * @param problems those in the data, after the lines
   * @param kind of the notice: a note, an error, or the status of a feed
   */
  updateFrame(lines: string[], kind: "note" | "error" | "status", problems: readonly Problem[] = []): void {
    setHidden(this.header, !this.#model.get("header"));
    setHidden(this.footer, !this.#model.get("footer"));
    const title = this.#model.get("title");
    setName(this.#title, title);
    set(this.root, "ariaLabel", `${this.#kind} ${title}`.trim());
    this.#notice.update(lines, problems, kind);
  }

  /** Announces words about the things that keys have moved to, to a screen reader. */
  say(words: string[]): void {
    setText(this.#live, words.filter(Boolean).join(", "));
  }

  /**
   * Marks the picture as old, with a text about it. An empty text only marks it, or, with `isSilent` false, removes the
   * mark.
   */
  updateSilence(words: string, isSilent = words !== ""): void {
    setText(this.#silence, words);
    this.root.classList.toggle("rw-silent", isSilent);
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
