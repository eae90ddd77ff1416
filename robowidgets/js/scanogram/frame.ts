import { make, setText } from "../shared/dom.ts";
import { keepKeys } from "../shared/keys.ts";
import { type Model, onChange } from "../shared/model.ts";
import { applyTheme, type Theme, watchTheme } from "../shared/theme.ts";
import type { ScanogramTraits } from "./traits.ts";

/** The frame round the picture: title and controls above, a notice over it, a footer below. */
export class Frame {
  readonly root = make("div", "rw-card rw-scanogram");
  readonly controls = make("span", "rw-controls");
  readonly picture = make("div", "rw-picture");
  readonly footer = make("div", "rw-footer");
  readonly #model: Model<ScanogramTraits>;
  readonly #header = make("div", "rw-header");
  readonly #title = make("span", "rw-title");
  readonly #facts = make("span", "rw-facts");
  readonly #notice = make("div", "rw-notice");
  #theme: Theme | null = null;

  /** @param redraw called when the picture must be drawn anew: for another theme, say */
  constructor(element: HTMLElement, model: Model<ScanogramTraits>, redraw: () => void, signal: AbortSignal) {
    this.#model = model;
    this.picture.tabIndex = 0;
    this.picture.role = "group";
    this.picture.ariaLabel = "scanogram widget";
    this.#notice.role = "status";
    this.#header.append(this.#title, this.#facts, this.controls);
    this.picture.append(this.#notice);
    this.root.append(this.#header, this.picture, this.footer);
    element.append(this.root);
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
    return this.#notice.offsetHeight;
  }

  update(facts: string[]): void {
    const { error, notes = [] } = this.#model.get("_about");
    this.#header.hidden = !this.#model.get("header");
    this.footer.hidden = !this.#model.get("footer");
    setText(this.#title, this.#model.get("title"));
    setText(this.#facts, facts.join(" · "));
    const lines = error ? [error, ...notes] : notes;
    this.#notice.classList.toggle("rw-error", Boolean(error));
    setText(this.#notice, lines.join(" · "));
    this.#notice.title = lines.join("\n");
  }
}
