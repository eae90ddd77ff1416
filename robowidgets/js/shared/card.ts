import { Bar } from "./bar.ts";
import { make, makeButton, makeIcon, setLabel, setText } from "./dom.ts";
import { isPlain, on } from "./events.ts";
import { toAge, toCount, toFixed } from "./format.ts";
import { keepKeys } from "./keys.ts";
import { type Model, onChange } from "./model.ts";
import { READING_MS, throttle } from "./schedule.ts";
import type { Frame, Stream } from "./stream.ts";
import { applyTheme, type Theme, watchTheme } from "./theme.ts";
import type { SampleTraits } from "./traits.ts";

const STEPS: Record<string, number> = { ",": -1, ".": 1 };
const PAUSE = "M2.5 1.5h2.5v9h-2.5z M7 1.5h2.5v9h-2.5z";
const PLAY = "M3 1.2l7 4.8-7 4.8z";

/** The frame round a picture: title and controls above, a notice over it, a footer below, and freezing and stepping. */
export class Card {
  readonly root: HTMLElement;
  readonly controls: HTMLElement;
  readonly picture: HTMLElement;
  readonly footer: HTMLElement;
  readonly #model: Model<SampleTraits>;
  readonly #stream: Stream<Frame>;
  readonly #header = make("div", "rw-header");
  readonly #title = make("span", "rw-title");
  readonly #facts = make("span", "rw-facts");
  readonly #notice = make("div", "rw-notice");
  readonly #silence = make("div", "rw-silence");
  readonly #freeze: HTMLButtonElement;
  readonly #freezeText = make("span", "");
  /** The words around the number are hidden in a narrow card. */
  readonly #freezeWords = ["rw-word", "rw-number", "rw-word"].map((name) => make("span", name));
  readonly #bar: Bar;
  readonly #tellFacts: () => void;
  #known: string[] = [];
  #paced = true;
  #paused: boolean | null = null;
  #theme: Theme | null = null;

  /**
   * @param kind name of the widget, for its CSS class and its label: "laser", "speed", "touch"
   * @param redraw draws the picture anew; called when the theme has changed
   */
  constructor(
    element: HTMLElement,
    kind: string,
    model: Model<SampleTraits>,
    stream: Stream<Frame>,
    redraw: () => void,
    signal: AbortSignal,
  ) {
    this.#model = model;
    this.#stream = stream;
    this.root = make("div", `rw-card rw-${kind}`);
    this.controls = make("span", "rw-controls");
    this.picture = make("div", "rw-picture");
    this.picture.tabIndex = 0;
    this.picture.role = "group";
    this.footer = make("div", "rw-footer");
    this.#notice.role = "status";
    this.#freeze = makeButton("rw-freeze", "", () => stream.toggle(), signal);
    this.#freezeText.append(...this.#freezeWords);
    this.#header.append(this.#title, this.#facts, this.controls);
    this.controls.append(this.#freeze);
    this.picture.append(this.#notice, this.#silence);
    this.#bar = new Bar(stream, signal);
    this.root.append(this.#header, this.picture, this.#bar.root, this.footer);
    element.append(this.root);
    const onTheme = () => {
      this.#theme = null;
      redraw();
    };
    watchTheme(onTheme, signal);
    onChange(model, ["title", "header", "footer", "_source"], redraw, signal);
    this.#tellFacts = throttle(() => this.#drawFacts(), READING_MS, signal);
    on(this.#header, "pointerenter", () => this.#tellAll(), signal);
    on(this.root, "keydown", (event) => this.#onKey(event), signal);
    keepKeys(this.root, signal);
    this.picture.ariaLabel = `${kind} widget`;
  }

  /** Colours and fonts. Read it while drawing: an element outside the page has no computed style. */
  get theme(): Theme {
    this.#theme ??= applyTheme(this.root);
    return this.#theme;
  }

  /** Inserts controls of the widget before the freeze button. */
  addControls(...elements: HTMLElement[]): void {
    for (const element of elements) this.controls.insertBefore(element, this.#freeze);
  }

  /** Height of the notice at the top of the picture, in pixels. */
  get noticeHeight(): number {
    return this.#notice.offsetHeight;
  }

  /** The text of a picture before the first sample. */
  waiting(noun: string): string {
    if (this.#stream.since) return `frozen before the first ${noun}`;
    return this.#model.get("_source").words || `waiting for a ${noun}`;
  }

  /**
   * Brings header, notice, bar and freeze button up to date.
   * @param facts about the source, shown after the title
   * @param noun for a sample: "scan"
   * @param paced whether samples come at a steady rate; without one, silence is no fault
   */
  update(facts: string[], noun: string, paced = true): void {
    this.#theme ??= applyTheme(this.root);
    const { error } = this.#model.get("_about");
    const { paused, since, about, shown, place } = this.#stream;
    const { notes = [] } = about;
    this.#header.hidden = !this.#model.get("header");
    this.footer.hidden = !this.#model.get("footer");
    setText(this.#title, this.#model.get("title"));
    this.#known = facts.filter(Boolean);
    this.#paced = paced;
    this.#tellFacts();
    const said = error ? [error + (shown ? ` Showing the last good ${noun}.` : ""), ...notes] : notes;
    // An empty picture shows the source's words itself.
    const source = this.#model.get("_source");
    const lines = [source.error, shown && source.words, ...said].filter(Boolean);
    this.#notice.classList.toggle("rw-error", Boolean(error || source.error));
    this.#notice.classList.toggle("rw-status", said.length === 0 && !source.error);
    this.#bar.update(this.footer.hidden ? null : place);
    setText(this.#notice, lines.join(" · "));
    this.#notice.title = lines.join("\n");

    this.root.classList.toggle("rw-frozen", paused);
    if (this.#paused !== paused) {
      this.#paused = paused;
      this.#freeze.ariaPressed = String(paused);
      setLabel(this.#freeze, paused ? "Show the newest again (space)" : "Freeze the picture (space)");
      this.#freeze.replaceChildren(makeIcon(paused ? PLAY : PAUSE), this.#freezeText);
    }
    const state = paused ? ["Frozen · ", toCount(since), " since"] : ["Freeze", "", ""];
    for (const [i, element] of this.#freezeWords.entries()) setText(element, state[i] ?? "");
  }

  /** Shows facts, rate and silence of the source; calls itself again while the source is silent. */
  #drawFacts(): void {
    const { live, rate } = this.#stream;
    const silence = this.#paced ? this.#stream.silence : 0;
    const pace = live && this.#paced && rate ? [`${toFixed(rate, 1)} Hz`] : [];
    setText(this.#facts, [...this.#known, ...pace].join(" ·\u00A0"));
    setText(this.#silence, silence ? `no data for ${toAge(silence)}` : "");
    this.root.classList.toggle("rw-silent", silence > 0 || this.#model.get("_source").lost === true);
    if (silence) this.#tellFacts();
  }

  /** The tooltip of the header: all facts about the source, line by line. */
  #tellAll(): void {
    const { arrived } = this.#stream;
    const { topic = this.#model.get("title"), type } = this.#model.get("_source");
    const age = arrived && `newest ${toAge(performance.now() - arrived)} ago`;
    this.#header.title = [topic, type, this.#facts.textContent, age].filter(Boolean).join("\n");
  }

  #onKey(event: KeyboardEvent): void {
    if (!isPlain(event)) return;
    if (this.#stream.step(STEPS[event.key] ?? 0)) event.preventDefault();
    if (event.key !== " " || event.target instanceof HTMLButtonElement) return;
    event.preventDefault();
    // The bar is hidden when the picture is released. Focus must not leave the card with it.
    this.picture.focus({ preventScroll: true });
    this.#stream.toggle();
  }
}
