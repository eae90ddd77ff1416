import { make, makeIcon, mount, set, setHidden, setText, setTip } from "../shared/dom.ts";
import { StopButtons } from "../shared/driving/buttons.ts";
import { StopControl } from "../shared/driving/control.ts";
import { Readout } from "../shared/driving/readout.ts";
import { on } from "../shared/events.ts";
import { toFixed } from "../shared/format.ts";
import { type Model, newName, onChange, onMessage } from "../shared/model.ts";
import { perAnimationFrame } from "../shared/schedule.ts";
import { followTheme } from "../shared/theme.ts";
import { watchInput } from "./input.ts";
import { CENTER, type Knob, toPlace } from "./knob.ts";
import { type Answer, PressLease } from "./press.ts";
import { toText } from "./text.ts";
import type { DriveTraits } from "./traits.ts";

const ARROW = "M6 3.2l4 5.6h-8z";
const SETTINGS = ["title", "header", "linear_limit", "angular_limit", "enabled"] as const;

/** One view of a drive pad: Stop, the pad with its knob, the texts, and the two numbers. */
export class DriveView {
  readonly #model: Model<DriveTraits>;
  readonly #root = make("div", "rw-card rw-drive");
  readonly #header = make("div", "rw-header");
  readonly #title = make("span", "rw-title");
  readonly #notice = make("div", "rw-notice rw-notice-text rw-error");
  readonly #pad = make("div", "rw-pad");
  readonly #stem = make("div", "rw-stem");
  readonly #knob = make("div", "rw-knob");
  readonly #text = make("div", "rw-words");
  readonly #hint = make("div", "rw-hint");
  readonly #slide = make("div", "rw-slide");
  readonly #sideways = make("div", "rw-sideways");
  readonly #linear = new Readout("linear", "m/s", 1, true);
  readonly #yaw = new Readout("yaw", "rad/s", -1, true);
  readonly #lateral = new Readout("lateral", "m/s", -1, true);
  readonly #lease: PressLease;
  readonly #stop: StopControl;
  readonly #buttons: StopButtons;
  readonly #redraw: () => void;
  #place: Knob = CENTER;

  constructor(model: Model<DriveTraits>, element: HTMLElement, signal: AbortSignal) {
    const name = newName();
    this.#model = model;
    this.#redraw = perAnimationFrame(() => this.#draw(), signal);
    this.#lease = new PressLease(name, (message) => model.send(message), this.#redraw);
    this.#stop = new StopControl(model, name, this.#redraw, signal);
    this.#buttons = new StopButtons(this.#root, this.#stop, signal);
    this.#build();
    mount(element, this.#root, signal);
    followTheme(this.#root, model, signal);
    onChange(model, SETTINGS, this.#redraw, signal);
    onMessage(model, (answer: Answer) => this.#lease.onAnswer(answer), signal);
    watchInput(this.#pad, this.#slide, this, signal);
    for (const change of ["focus", "blur"] as const) on(this.#pad, change, this.#redraw, signal);
    this.#draw();
  }

  get sideways(): boolean {
    return this.#lateralLimit > 0;
  }

  /** A notebook saved by an earlier version lacks this trait. */
  get #lateralLimit(): number {
    return this.#model.get("_state").lateral_limit ?? 0;
  }

  onHold(knob: Knob): void {
    this.#place = knob;
    this.#lease.hold(knob);
    this.#redraw();
  }

  onRelease(): void {
    this.#place = CENTER;
    this.#lease.release();
    this.#redraw();
  }

  #build(): void {
    const side = make("div", "rw-side");
    const texts = make("div", "rw-pad-words");
    texts.role = "status";
    texts.append(this.#text, this.#hint, this.#buttons.allow);
    side.append(texts, this.#linear.root, this.#yaw.root, this.#lateral.root);
    addArrows(this.#pad, ["up", "left", "right", "down"]);
    this.#pad.append(this.#stem, this.#knob);
    this.#pad.tabIndex = 0;
    this.#pad.role = "application";
    addArrows(this.#slide, ["left", "right"]);
    this.#slide.append(make("div", "rw-knob"));
    this.#sideways.append(this.#slide, make("div", "rw-sideways-name", "sideways: Q and E"));
    const knobs = make("div", "rw-knobs");
    knobs.append(this.#pad, this.#sideways);
    const field = make("div", "rw-picture");
    field.append(knobs, side);
    this.#header.append(this.#title);
    this.#notice.role = "alert";
    // The notice is below the pad, so that it moves neither Stop nor the pad under a finger.
    this.#root.append(this.#header, this.#buttons.stop, field, this.#notice);
  }

  #draw(): void {
    const [model, stop, { held }] = [this.#model, this.#stop, this.#lease];
    const { told } = stop;
    setHidden(this.#header, !model.get("header"));
    setText(this.#title, model.get("title") || "drive");
    this.#buttons.update();
    setText(this.#notice, told.error || (told.driver ? told.status : ""));
    const enabled = model.get("enabled");
    const { text, hint, kind } = toText(stop, this.#lease, enabled);
    setText(this.#text, text);
    setText(this.#hint, hint);
    setTip(this.#text, told.sender ?? "");
    set(this.#root.dataset, "kind", kind);
    this.#root.classList.toggle("rw-off", !told.ready || !enabled || told.stopped);
    this.#linear.update(told.speed[0], model.get("linear_limit"));
    this.#yaw.update(told.speed[1], model.get("angular_limit"));
    this.#lateral.update(told.speed[2] ?? 0, this.#lateralLimit || 1);
    for (const element of [this.#sideways, this.#lateral.root]) setHidden(element, !this.sideways);
    const keys = this.sideways ? "W, A, S, D drive, Q and E drive sideways" : "W, A, S, D drive";
    set(this.#pad, "ariaLabel", `Drive pad: arrow keys or ${keys}, space lets go, escape stops`);
    const { right, below, slide } = toPlace(held ? this.#place : CENTER);
    for (const [name, share] of Object.entries({ right, below, slide })) {
      this.#root.style.setProperty(`--rw-${name}`, toFixed(share, 3).replace("\u2212", "-"));
    }
    this.#stem.style.setProperty("--rw-angle", `${Math.atan2(below, right)}rad`);
    this.#stem.style.setProperty("--rw-length", String(Math.hypot(right, below)));
  }
}

function addArrows(surface: HTMLElement, edges: string[]): void {
  for (const edge of edges) {
    const arrow = makeIcon(ARROW);
    arrow.classList.add(`rw-${edge}`);
    surface.append(arrow);
  }
}
