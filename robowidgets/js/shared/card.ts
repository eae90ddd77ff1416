import { make, makeButton, makeIcon, setText } from "./dom.ts";
import { toCount } from "./format.ts";
import { getAbout, getFlag, getString, type Model, onChange } from "./model.ts";
import type { Frame, Stream } from "./stream.ts";
import { applyTheme, type Theme, watchTheme } from "./theme.ts";

const PAUSE = "M2.5 1.5h2.5v9h-2.5z M7 1.5h2.5v9h-2.5z";
const PLAY = "M3 1.2l7 4.8-7 4.8z";

/** The frame round a picture: title and controls above, a notice over it, a footer below, and freezing. */
export class Card {
  readonly root: HTMLElement;
  readonly controls: HTMLElement;
  readonly picture: HTMLElement;
  readonly footer: HTMLElement;
  readonly #model: Model;
  readonly #stream: Stream<Frame>;
  readonly #header = make("div", "rw-header");
  readonly #title = make("span", "rw-title");
  readonly #facts = make("span", "rw-facts");
  readonly #notice = make("div", "rw-notice");
  readonly #freeze: HTMLButtonElement;
  readonly #freezeText = make("span", "rw-freeze-text");
  #theme: Theme | null = null;

  /**
   * @param kind what the widget is, for its class and for readers of screens: "laser", "speed", "touch"
   * @param redraw called when the theme changed and the picture must be drawn anew
   */
  constructor(
    element: HTMLElement,
    kind: string,
    model: Model,
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
    this.picture.setAttribute("role", "group");
    this.footer = make("div", "rw-footer");
    this.#notice.setAttribute("role", "status");
    this.#freeze = makeButton("rw-freeze", "Freeze the picture (space)", () => stream.toggle(), signal);
    this.#freeze.append(makeIcon(PAUSE), this.#freezeText);
    this.#header.append(this.#title, this.#facts, this.controls);
    this.controls.append(this.#freeze);
    this.picture.append(this.#notice);
    this.root.append(this.#header, this.picture, this.footer);
    element.append(this.root);
    const onTheme = () => {
      this.#theme = null;
      redraw();
    };
    watchTheme(onTheme, signal);
    onChange(model, ["title", "header", "footer"], redraw, signal);
    this.picture.addEventListener("keydown", (event) => this.#onKey(event), { signal });
    window.addEventListener("keydown", (event) => this.#keep(event), { signal, capture: true });
    this.picture.setAttribute("aria-label", `${kind} widget`);
  }

  /** Colours and fonts; to be asked for when drawing, for an element outside the page has none. */
  get theme(): Theme {
    this.#theme ??= applyTheme(this.root);
    return this.#theme;
  }

  /** Puts controls of the widget before the freeze button. */
  addControls(...elements: HTMLElement[]): void {
    for (const element of elements) this.controls.insertBefore(element, this.#freeze);
  }

  /** Room that the notice takes at the top of the picture, in pixels. */
  get noticeHeight(): number {
    return this.#notice.hidden ? 0 : this.#notice.offsetHeight;
  }

  /**
   * Brings header, notice and freeze button up to date.
   * @param facts what is known of the source, after the title
   * @param noun one sample, in words: "scan"
   */
  update(facts: string[], noun: string): void {
    this.#theme ??= applyTheme(this.root);
    const { error, notes = [] } = getAbout(this.#model);
    const { paused, since } = this.#stream;
    this.#header.hidden = !getFlag(this.#model, "header");
    this.footer.hidden = !getFlag(this.#model, "footer");
    setText(this.#title, getString(this.#model, "title"));
    this.#title.hidden = !getString(this.#model, "title");
    setText(this.#facts, facts.filter(Boolean).join(" · "));
    this.#facts.title = this.#facts.textContent ?? "";
    const kept = this.#stream.shown ? ` Showing the last good ${noun}.` : "";
    const lines = error ? [error + kept, ...notes] : notes;
    this.#notice.hidden = lines.length === 0;
    this.#notice.classList.toggle("rw-error", Boolean(error));
    setText(this.#notice, lines.join(" · "));
    this.#notice.title = lines.join("\n");

    this.root.classList.toggle("rw-frozen", paused);
    const pressed = String(paused);
    if (this.#freeze.getAttribute("aria-pressed") !== pressed) {
      this.#freeze.setAttribute("aria-pressed", pressed);
      this.#freeze.title = paused ? "Show the newest again (space)" : "Freeze the picture (space)";
      this.#freeze.setAttribute("aria-label", this.#freeze.title);
      this.#freeze.replaceChildren(makeIcon(paused ? PLAY : PAUSE), this.#freezeText);
    }
    const words = paused ? `<Frozen · >${toCount(since)}< since>` : "<Freeze>";
    this.#setFreezeText(words);
  }

  /** Parts in angle brackets are words that give way where room is short; numbers stay. */
  #setFreezeText(words: string): void {
    if (this.#freezeText.dataset.words === words) return;
    this.#freezeText.dataset.words = words;
    const parts = words.split(/[<>]/).map((part, i) => make("span", i % 2 ? "rw-word" : "rw-number", part));
    this.#freezeText.replaceChildren(...parts.filter((part) => part.textContent));
  }

  /**
   * Keeps plain keys from JupyterLab, which would take them for the notebook: "x" cuts the cell. It asks the focused
   * element, before any parent, when the event passes the document. Saving and running a cell stay its own.
   */
  #keep({ key, ctrlKey, altKey, metaKey }: KeyboardEvent): void {
    const { activeElement: focused } = document;
    if (!this.root.contains(focused)) return;
    focused?.toggleAttribute("data-lm-suppress-shortcuts", !(ctrlKey || altKey || metaKey || key === "Enter"));
  }

  #onKey(event: KeyboardEvent): void {
    if (event.key !== " " || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    this.#stream.toggle();
  }
}
