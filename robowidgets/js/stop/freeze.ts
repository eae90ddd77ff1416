import { make, makeButton, makeIcon, PAUSE, PLAY, set, setHidden, setText } from "../shared/dom.ts";
import { type Model, onChange } from "../shared/model.ts";
import { join, type Member, othersOf, setFrozen } from "../shared/together.ts";
import type { StopTraits } from "./traits.ts";

/** The one Freeze of a view: it freezes and releases all pictures of a group, and shows whether they are frozen. */
export class Freeze implements Member {
  readonly button: HTMLButtonElement;
  readonly oldest = -Infinity;
  readonly onOthers: () => void;
  readonly #model: Model<StopTraits>;
  readonly #text = make("span", "");
  #isShown: boolean | null = null;

  constructor(model: Model<StopTraits>, redraw: () => void, signal: AbortSignal) {
    this.#model = model;
    this.onOthers = redraw;
    const onClick = () => setFrozen(this.#pictures, !this.paused);
    this.button = makeButton("rw-freeze-all", "", onClick, signal);
    this.button.ariaLabel = null;
    onChange(model, ["_together"], redraw, signal);
    join(this, signal);
  }

  get group(): string {
    return this.#model.get("_together");
  }

  get robot(): string {
    return this.#model.get("_robot");
  }

  get paused(): boolean {
    return this.#pictures.some(({ paused }) => paused);
  }

  /** The members without those that only pass the request on, as it does: the page may show a bar twice. */
  get #pictures(): Member[] {
    return othersOf(this).filter((member) => !(member instanceof Freeze));
  }

  /** The pictures do it themselves, also those on another page. */
  freeze(): void {}
  release(): void {}
  showAt(): void {}

  update(): void {
    const { paused } = this;
    setHidden(this.button, this.#pictures.length === 0);
    if (this.#isShown === paused) return;
    this.#isShown = paused;
    set(this.button, "ariaPressed", String(paused));
    set(this.button, "title", paused ? "Show the newest again" : "Freeze all pictures of this view");
    setText(this.#text, paused ? "Frozen" : "Freeze");
    this.button.replaceChildren(makeIcon(paused ? PLAY : PAUSE), this.#text);
  }
}
