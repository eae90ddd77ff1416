import { make, makeIcon, setText } from "../shared/dom.ts";
import { on } from "../shared/events.ts";
import { toFixed } from "../shared/format.ts";
import { keepKeys } from "../shared/keys.ts";
import { getFlag, getNumber, getString, type Model, onChange } from "../shared/model.ts";
import { onceAFrame } from "../shared/schedule.ts";
import { applyTheme, watchTheme } from "../shared/theme.ts";
import { type Answer, Grip } from "./grip.ts";
import { watchHands } from "./hands.ts";
import { CENTER, type Knob, toPlace } from "./knob.ts";
import { Readout } from "./readout.ts";
import { toWords } from "./words.ts";

/** What Python says: the speed handed on last, the press that holds the pad, what went wrong, and why a press ended. */
interface Told {
  speed: [number, number];
  press: string;
  error: string;
  cause: string;
}

const ARROW = "M6 3.2l4 5.6h-8z";
const SETTINGS = ["title", "header", "linear_limit", "angular_limit", "enabled", "_ready", "_state"];

/** One view of a drive pad: the pad with its knob, the words, and the two numbers. */
export class DriveView {
  readonly #model: Model;
  readonly #root = make("div", "rw-card rw-drive");
  readonly #header = make("div", "rw-header");
  readonly #title = make("span", "rw-title");
  readonly #notice = make("div", "rw-notice rw-error");
  readonly #pad = make("div", "rw-pad");
  readonly #stem = make("div", "rw-stem");
  readonly #knob = make("div", "rw-knob");
  readonly #words = make("div", "rw-words");
  readonly #hint = make("div", "rw-hint");
  readonly #linear = new Readout("linear", "m/s", 1);
  readonly #angular = new Readout("angular", "rad/s", -1);
  readonly #grip: Grip;
  readonly #redraw: () => void;
  #place: Knob = CENTER;

  constructor(model: Model, element: HTMLElement, signal: AbortSignal) {
    this.#model = model;
    this.#redraw = onceAFrame(() => this.#draw(), signal);
    this.#grip = new Grip(crypto.randomUUID().slice(0, 8), (message) => model.send(message), this.#redraw);
    this.#build();
    element.append(this.#root);
    watchTheme(this.#redraw, signal);
    keepKeys(this.#root, signal);
    onChange(model, SETTINGS, this.#redraw, signal);
    const onMessage = (answer: Answer) => this.#grip.onAnswer(answer);
    model.on("msg:custom", onMessage);
    signal.addEventListener("abort", () => model.off("msg:custom", onMessage));
    watchHands(this.#pad, this, signal);
    for (const change of ["focus", "blur"] as const) on(this.#pad, change, this.#redraw, signal);
    this.#draw();
  }

  onHold(knob: Knob): void {
    this.#place = knob;
    this.#grip.hold(knob);
    this.#redraw();
  }

  onRelease(): void {
    this.#place = CENTER;
    this.#grip.release();
    this.#redraw();
  }

  #build(): void {
    const side = make("div", "rw-side");
    const said = make("div", "rw-said-words");
    said.role = "status";
    said.append(this.#words, this.#hint);
    side.append(said, this.#linear.root, this.#angular.root);
    for (const edge of ["up", "left", "right", "down"]) {
      const arrow = makeIcon(ARROW);
      arrow.classList.add(`rw-${edge}`);
      this.#pad.append(arrow);
    }
    this.#pad.append(this.#stem, this.#knob);
    this.#pad.tabIndex = 0;
    this.#pad.role = "application";
    this.#pad.ariaLabel = "Drive pad: arrow keys or W, A, S, D drive, space stops";
    const field = make("div", "rw-picture");
    field.append(this.#pad, side);
    this.#header.append(this.#title);
    this.#notice.role = "alert";
    this.#root.append(this.#header, this.#notice, field);
  }

  #draw(): void {
    const [model, { state, held, press }] = [this.#model, this.#grip];
    applyTheme(this.#root);
    const told = model.get("_state") as Told;
    const title = getString(model, "title") || "drive";
    this.#header.hidden = !getFlag(model, "header");
    setText(this.#title, title);
    if (told.error || !held) setText(this.#notice, told.error);
    // While it is held, the pad stays where it is under the pointer.
    this.#notice.style.visibility = told.error ? "" : "hidden";
    const elsewhere = told.press !== "" && told.press !== press;
    const { text, hint, kind } = toWords({
      state,
      ready: getFlag(model, "_ready"),
      enabled: getFlag(model, "enabled"),
      elsewhere,
      cause: told.cause,
    });
    setText(this.#words, text);
    setText(this.#hint, hint);
    this.#root.dataset.kind = kind;
    this.#root.classList.toggle("rw-off", !getFlag(model, "_ready") || !getFlag(model, "enabled"));
    this.#linear.update(told.speed[0], getNumber(model, "linear_limit"));
    this.#angular.update(told.speed[1], getNumber(model, "angular_limit"));
    const { right, below } = held ? toPlace(this.#place) : { right: 0, below: 0 };
    for (const [name, share] of Object.entries({ right, below })) {
      this.#pad.style.setProperty(`--rw-${name}`, toFixed(share, 3).replace("\u2212", "-"));
    }
    this.#stem.style.setProperty("--rw-angle", `${Math.atan2(below, right)}rad`);
    this.#stem.style.setProperty("--rw-length", String(Math.hypot(right, below)));
  }
}
