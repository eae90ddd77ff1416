import {
  make,
  makeButton,
  makeIcon,
  mount,
  PAUSE,
  PLAY,
  RESET,
  set,
  setHidden,
  setLabel,
  setName,
  setText,
  setTip,
} from "../shared/dom.ts";
import { StopButtons } from "../shared/driving/buttons.ts";
import { StopControl } from "../shared/driving/control.ts";
import { Readout } from "../shared/driving/readout.ts";
import { toDriverText } from "../shared/driving/text.ts";
import { on } from "../shared/events.ts";
import { type Model, newName } from "../shared/model.ts";
import { perAnimationFrame } from "../shared/schedule.ts";
import { followTheme } from "../shared/theme.ts";
import { NOT_KNOWN, toCode, toMode, toNotice } from "./text.ts";
import type { Program, ProgramTraits } from "./traits.ts";
import { VariableRows } from "./variables.ts";

const RESTART = "Restart from the beginning, with an empty state, and let programs drive";
const STEP = "M2 1.2l6 4.8-6 4.8z M8.5 1.5h1.5v9h-1.5z";

/** A program: its state, its variables, its prints or its error, and Stop. */
export class ProgramView {
  readonly #model: Model<ProgramTraits>;
  readonly #control: StopControl;
  readonly #buttons: StopButtons;
  readonly #variables: VariableRows;
  readonly #root = make("div", "rw-card rw-program");
  readonly #name = make("span", "rw-title");
  readonly #version = make("span", "rw-version");
  readonly #mode = make("span", "rw-program-mode");
  readonly #run: HTMLButtonElement;
  readonly #step: HTMLButtonElement;
  readonly #restart: HTMLButtonElement;
  readonly #facts = [make("b", ""), make("b", ""), make("b", "")];
  readonly #active = make("div", "rw-program-active");
  readonly #code = make("code", "rw-program-code");
  readonly #axes = [
    new Readout("linear", "m/s", 1, false),
    new Readout("yaw", "rad/s", -1, false),
    new Readout("lateral", "m/s", -1, false),
  ];
  readonly #kept = make("dl", "rw-program-kept rw-pale");
  readonly #prints = make("div", "rw-prints");
  readonly #hint = make("div", "rw-hint");

  constructor(model: Model<ProgramTraits>, element: HTMLElement, signal: AbortSignal) {
    this.#model = model;
    const redraw = perAnimationFrame(() => this.#draw(), signal);
    this.#control = new StopControl(model, newName(), redraw, signal);
    this.#buttons = new StopButtons(this.#root, this.#control, signal);
    this.#variables = new VariableRows((name, value) => this.#control.send({ program: "set", name, value }), signal);
    this.#run = makeButton("rw-program-run", "Run", () => this.#onRun(), signal);
    const onStep = () => this.#control.send({ program: "step" });
    this.#step = makeButton("rw-program-step", "Make one step", onStep, signal);
    this.#step.append(makeIcon(STEP), make("span", "rw-verb", "Step"));
    this.#restart = makeButton("", RESTART, () => this.#onRestart(), signal);
    this.#restart.append(makeIcon(RESET), make("span", "rw-verb", "Restart"));
    on(window, "keydown", ({ key }) => key === "Escape" && this.#variables.cancel(), signal, { capture: true });
    this.#build();
    mount(element, this.#root, signal);
    followTheme(this.#root, model, signal);
    this.#draw();
  }

  get #program(): Program | null {
    return this.#model.get("_state").program;
  }

  #build(): void {
    const controls = make("div", "rw-controls");
    controls.append(this.#run, this.#step, this.#restart);
    const header = make("div", "rw-header");
    header.append(this.#name, this.#version, this.#mode, controls);
    const facts = make("div", "rw-program-facts");
    for (const [i, unit] of [" Hz", " ms a step", " s since its start"].entries()) {
      const fact = make("span", "");
      fact.append(this.#facts[i] ?? "", unit);
      facts.append(fact);
    }
    const returns = make("div", "rw-program-returns");
    returns.append(make("span", "", "returns"), this.#code);
    const axes = make("div", "rw-program-axes");
    axes.append(...this.#axes.map(({ root }) => root));
    const driving = make("div", "rw-program-driving rw-pale");
    driving.append(facts, this.#active, returns, axes);
    this.#prints.role = "status";
    const stop = make("div", "rw-program-stop");
    stop.append(this.#buttons.stop, this.#hint);
    this.#root.append(header, driving, this.#variables.root, this.#kept, this.#prints, stop);
  }

  #onRun(): void {
    const isRunning = this.#isRunning;
    if (!isRunning && this.#control.told.stopped) this.#control.allow();
    this.#control.send({ program: isRunning ? "pause" : "run" });
  }

  #onRestart(): void {
    if (this.#control.told.stopped) this.#control.allow();
    this.#control.send({ program: "restart" });
  }

  get #isRunning(): boolean {
    return this.#program?.mode === "running" && !this.#control.told.stopped;
  }

  #draw(): void {
    this.#buttons.update();
    const told = this.#model.get("_state");
    const program = this.#program;
    const isKnown = this.#control.hasKernel && !this.#control.silence;
    const mode = program ? toMode(told, program, isKnown) : "";
    set(this.#root.dataset, "mode", mode || "none");
    this.#root.classList.toggle("rw-silent", mode === NOT_KNOWN);
    setName(this.#name, program?.name ?? "no program yet");
    setText(this.#version, program ? `v${program.version}` : "");
    setText(this.#mode, mode);
    const [verb, label] = this.#isRunning
      ? ["Pause", "Pause, and stop the robot"]
      : ["Run", "Run, and let programs drive"];
    if (this.#run.textContent !== verb)
      this.#run.replaceChildren(makeIcon(this.#isRunning ? PAUSE : PLAY), make("span", "rw-verb", verb));
    setLabel(this.#run, label);
    const isOver = !program || program.mode === "ended" || !this.#control.hasKernel;
    const isUnknown = mode === NOT_KNOWN;
    set(this.#run, "disabled", isOver || (isUnknown && !this.#isRunning));
    set(this.#restart, "disabled", isOver || isUnknown);
    set(this.#step, "disabled", isOver || isUnknown || this.#isRunning || told.stopped);
    const numbers = program ? [program.rate.toFixed(1), program.step_ms.toFixed(2), String(program.since)] : [];
    for (const [i, fact] of this.#facts.entries()) setText(fact, numbers[i] ?? "\u2013");
    setText(this.#active, program?.active ?? "");
    const speed: Program["speed"] = (!told.stopped && program?.speed) || [0, 0, 0];
    setText(this.#code, program ? toCode(speed, program.kept && !told.stopped) : "\u2013");
    for (const [i, axis] of this.#axes.entries()) {
      const [value, limit] = [speed[i] ?? 0, program?.limits[i] ?? 0];
      setHidden(axis.root, i === 2 && !limit && !value);
      axis.update(value, limit || 1);
    }
    this.#variables.update(told.variables ?? []);
    this.#drawKept(told.kept ?? []);
    this.#drawPrints(program);
    const { text, hint, kind } = toDriverText(this.#control);
    setText(this.#hint, [text, hint].filter(Boolean).join(" \u00b7 "));
    set(this.#hint.dataset, "kind", kind);
    setTip(this.#hint, this.#control.told.sender ?? "");
  }

  /** Draws a row for each value that the program keeps. */
  #drawKept(kept: [name: string, value: string][]): void {
    setHidden(this.#kept, kept.length === 0);
    while (this.#kept.children.length > 2 * kept.length) this.#kept.lastChild?.remove();
    for (const [i, [name, value]] of kept.entries()) {
      if (!this.#kept.children[2 * i]) this.#kept.append(make("dt", ""), make("dd", ""));
      const [label, text] = [this.#kept.children[2 * i], this.#kept.children[2 * i + 1]] as HTMLElement[];
      if (!label || !text) continue;
      setText(label, name);
      setText(text, value);
      set(text, "title", value);
    }
  }

  /** Draws the last three lines, or instead the error or the reason why it does not drive. */
  #drawPrints(program: Program | null): void {
    const notice = program ? toNotice(this.#model.get("_state"), program) : { text: "", isError: false };
    const lines = notice.text ? [] : (program?.prints ?? []);
    set(this.#prints.dataset, "kind", notice.isError ? "error" : notice.text ? "notice" : "prints");
    const rows = lines.map(([seconds, text]) => [seconds.toFixed(2), text] as const);
    const shown = notice.text ? ([["", notice.text]] as const) : rows;
    const words = shown.map((row) => row.join("\t")).join("\n");
    if (words === this.#prints.dataset.words) return;
    this.#prints.dataset.words = words;
    this.#prints.replaceChildren(
      ...shown.map(([time, text]) => {
        const line = make("div", "rw-print");
        if (time) line.append(make("span", "rw-print-time", time));
        line.append(make("span", "rw-print-text", text));
        return line;
      }),
    );
  }
}
