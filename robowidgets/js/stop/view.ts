import { make, mount, set, setText, setTip } from "../shared/dom.ts";
import { StopButtons } from "../shared/driving/buttons.ts";
import { StopControl } from "../shared/driving/control.ts";
import { toDriverText } from "../shared/driving/text.ts";
import { type Model, newName, onChange } from "../shared/model.ts";
import { perAnimationFrame } from "../shared/schedule.ts";
import { followTheme } from "../shared/theme.ts";
import { Beside } from "./beside.ts";
import { Freeze } from "./freeze.ts";
import type { StopTraits } from "./traits.ts";

/** A bar: Stop, the source of the speeds and the speed, problems, and the Freeze of its view. */
export class StopView {
  readonly #model: Model<StopTraits>;
  readonly #control: StopControl;
  readonly #buttons: StopButtons;
  readonly #freeze: Freeze;
  readonly #beside: Beside;
  readonly #root = make("div", "rw-card rw-stop-bar");
  readonly #text = make("div", "rw-stop-text");
  readonly #hint = make("div", "rw-hint");
  readonly #notice = make("div", "rw-notice rw-notice-text rw-error");

  constructor(model: Model<StopTraits>, element: HTMLElement, signal: AbortSignal) {
    this.#model = model;
    const redraw = perAnimationFrame(() => this.#draw(), signal);
    onChange(model, ["_black_box"], redraw, signal);
    this.#control = new StopControl(model, newName(), redraw, signal);
    this.#buttons = new StopButtons(this.#root, this.#control, signal);
    this.#freeze = new Freeze(model, redraw, signal);
    this.#beside = new Beside(model, this.#root, signal);
    const texts = make("div", "rw-stop-words");
    texts.role = "status";
    texts.append(this.#text, this.#hint);
    this.#notice.role = "alert";
    const row = make("div", "rw-stop-row");
    row.append(this.#buttons.stop, texts, this.#buttons.allow, this.#freeze.button, this.#beside.button);
    this.#root.append(row, this.#beside.words, this.#notice);
    mount(element, this.#root, signal);
    followTheme(this.#root, model, signal);
    this.#draw();
  }

  #draw(): void {
    this.#buttons.update();
    this.#freeze.update();
    this.#beside.update();
    const { text, hint, kind } = toDriverText(this.#control);
    set(this.#root.dataset, "kind", kind);
    setText(this.#text, text);
    setTip(this.#text, this.#control.told.sender ?? "");
    const { error, status } = this.#control.told;
    const isAlarm = hint !== "" && hint === status;
    setText(this.#hint, [hint, isAlarm ? "" : this.#model.get("_black_box")].filter(Boolean).join(" · "));
    this.#hint.classList.toggle("rw-alarm", isAlarm);
    setText(this.#notice, error);
  }
}
