import { make, makeButton, set, setHidden, setLabel, setText } from "../shared/dom.ts";
import { isPlain, on, onAbort } from "../shared/events.ts";
import { toCount, toFixed } from "../shared/format.ts";
import { type Lit, light, onPointedRays, type PointedRay, pointedRays, readsOne } from "../shared/lit.ts";
import { type Model, onChange, setTraits } from "../shared/model.ts";
import { SampleCard } from "../shared/sample_card.ts";
import type { Stream } from "../shared/stream.ts";
import type { Codes } from "./codes.ts";
import { drawGraph, SECONDS } from "./graph.ts";
import { Recorded } from "./recorded.ts";
import { Row } from "./row.ts";
import { type Call, type Line, type Step, type Steps, type Trace, tracesOf } from "./steps.ts";
import type { FunctionCode, LinesAbout, LinesTraits, VersionCode } from "./traits.ts";

const STEPS: Record<string, number> = { ",": -1, ".": 1 };
const MOVES: Record<string, number> = { ArrowDown: 1, ArrowUp: -1 };
/** The maximum width of code, in characters, with values next to it. */
const WIDEST = 56;

/** One view of a program's lines: their code, their values, and their graphs. */
export class LinesView {
  readonly #model: Model<LinesTraits>;
  readonly #stream: Stream<Steps>;
  readonly #codes: Codes;
  readonly #card: SampleCard;
  readonly #table = make("div", "rw-lines-table rw-pale");
  readonly #empty = make("div", "rw-empty");
  readonly #back: HTMLButtonElement;
  readonly #next: HTMLButtonElement;
  readonly #fold: HTMLButtonElement;
  readonly #said = make("span", "rw-lines-said");
  #sections: Section[] = [];
  #shown: VersionCode | null = null;
  /** The frame on show, and the index of the step in it. */
  #at = { sequence: -1, index: 0 };
  /** The robot whose rays are lit. A closed model has no robot any more. */
  #lit = "";
  #pointed: { section: Section; line: number } | null = null;
  readonly #recorded: Recorded;

  constructor(
    model: Model<LinesTraits>,
    element: HTMLElement,
    stream: Stream<Steps>,
    codes: Codes,
    signal: AbortSignal,
  ) {
    this.#model = model;
    this.#stream = stream;
    this.#codes = codes;
    this.#card = new SampleCard(element, "lines", model, stream, () => this.#draw(), signal);
    this.#back = makeButton("rw-step", "One step back (,)", () => this.#step(-1), signal, "\u2039");
    this.#next = makeButton("rw-step", "One step on (.)", () => this.#step(1), signal, "\u203a");
    this.#fold = makeButton("rw-unfold", "", () => this.#toggleFold(), signal, "");
    this.#card.addControls(this.#back, this.#next);
    this.#card.controls.append(this.#fold);
    this.#table.role = "table";
    this.#recorded = new Recorded(model, this.#card.redraw, signal);
    this.#card.picture.append(this.#recorded.button, this.#table, this.#empty);
    this.#card.footer.append(this.#said);
    const { root } = this.#card;
    // Before the listener of the card, which would go from frame to frame and skip the steps between them.
    on(root, "keydown", (event) => this.#onKey(event), signal, { capture: true });
    on(this.#table, "pointerover", ({ target }) => this.#point(target), signal);
    on(this.#table, "pointerleave", () => this.#point(null), signal);
    on(this.#table, "focusin", ({ target }) => this.#point(target), signal);
    on(this.#table, "focusout", () => this.#point(null), signal);
    on(this.#table, "click", ({ target }) => this.#choose(target), signal);
    onPointedRays(this.#card.redraw, signal);
    onChange(model, ["_code", "folded", "_drive", "_chosen", "_offer"], this.#card.redraw, signal);
    onAbort(signal, () => this.#point(null));
  }

  get #step_(): Step | null {
    const frame = this.#stream.shown;
    if (!frame) return null;
    if (frame.sequence !== this.#at.sequence || !this.#stream.paused) {
      this.#at = { sequence: frame.sequence, index: frame.steps.length - 1 };
    }
    return frame.steps[this.#at.index] ?? null;
  }

  #draw(): void {
    const frame = this.#stream.shown;
    const step = this.#step_;
    const { mode = "running", version, failure = "" } = this.#stream.about as LinesAbout;
    const isFolded = this.#model.get("folded");
    const { paused } = this.#stream;
    const code = this.#codes.of(frame?.key);
    const { span } = this.#recorded;
    this.#card.canFreeze = !span;
    this.#recorded.drawButton();
    // A function of samples has no steps before the one on show.
    const number = step?.number ? [`step ${toCount(step.number)}`] : [];
    const time = step && (step.calls.length || !span) ? [`${toFixed(step.time, 2)} s`] : [];
    const facts = step ? [...number, ...time] : [];
    const said = mode === "running" ? "" : mode === "replaced" ? "a newer version drives" : mode;
    this.#card.update(
      [version ? `v${code.version ?? version}` : "", ...facts, said, isFolded ? summaryOf(step, code) : ""],
      "step",
      false,
    );
    set(this.#card.root.dataset, "folded", String(isFolded));
    set(this.#fold, "ariaExpanded", String(!isFolded));
    setLabel(this.#fold, isFolded ? "Show the lines" : "Show one line only");
    for (const button of [this.#back, this.#next]) setHidden(button, !paused || !this.#stream.place);
    setHidden(this.#empty, step !== null);
    setHidden(this.#table, !step);
    setText(this.#empty, this.#card.waiting("step"));
    this.#card.picture.style.paddingTop = `${this.#card.noticeHeight}px`;
    if (!frame || !step || isFolded) {
      this.#unpoint();
      return;
    }
    if (code !== this.#shown) this.#build(code);
    const rays = pointedRays(this.#stream.robot);
    const { chosen } = this.#recorded;
    for (const section of this.#sections) {
      section.update(step, failure || (span && this.#sections.length === 1 ? "-" : ""));
      section.mark(step, rays, chosen);
    }
    if (span) this.#drawDrive(step, span);
    else this.#drawGraphs(frame, step);
    this.#say(frame);
    this.#light(step);
  }

  /** Makes the rows of another version. */
  #build(code: VersionCode): void {
    this.#shown = code;
    this.#unpoint();
    const functions = code.functions ?? [];
    this.#sections = functions.map((one) => new Section(one, functions.length > 1));
    this.#table.ariaLabel = `lines of ${code.name ?? "the program"}`;
    const longest = Math.max(0, ...functions.flatMap(({ texts }) => texts.map(({ length }) => length)));
    this.#table.style.setProperty("--rw-code-width", `${Math.min(WIDEST, longest) + 1}ch`);
    this.#table.replaceChildren(...this.#sections.map(({ root }) => root));
    const [first] = this.#rows;
    if (first) first.tabIndex = 0;
  }

  get #rows(): HTMLElement[] {
    return this.#sections.flatMap((section) => (section.root.hidden ? [] : section.rows.map(({ root }) => root)));
  }

  #drawGraphs(frame: Steps, step: Step): void {
    const newest = this.#stream.moments.at(-1);
    const end = this.#stream.paused && newest ? this.#stream.frameOf(newest).arrived : step.at;
    const from = Math.min(end - SECONDS, step.at);
    const until = from + SECONDS;
    const kept = this.#stream.moments.map((moment) => this.#stream.frameOf(moment));
    const frames = kept.length ? kept : [frame];
    const traces = tracesOf(frames, frame.key, from);
    const { theme, size } = this.#card;
    const cursor = this.#stream.paused ? step.at : null;
    for (const { code, rows, kinds } of this.#sections) {
      for (const [i, row] of rows.entries()) {
        const trace: Trace = traces.get(`${code.key}:${i}`) ?? [];
        drawGraph(row.graph, trace, kinds.get(i) ?? "reached", [from, until], cursor, theme, size.ratio);
      }
    }
  }

  /** Draws the graphs over the whole recording. */
  #drawDrive(step: Step, span: [from: number, to: number]): void {
    const { theme, size } = this.#card;
    for (const { code, rows, kinds } of this.#sections) {
      for (const [i, row] of rows.entries()) {
        const { kind = "reached", trace = [] } = this.#recorded.graphOf(code.key, i) ?? {};
        if (trace.length) kinds.set(i, kind);
        drawGraph(row.graph, trace, kind, span, step.at, theme, size.ratio);
      }
    }
  }

  /** Writes in the footer how often the pointed or focused line was reached, and was true. */
  #say(frame: Steps): void {
    const { section, line = -1 } = this.#pointed ?? {};
    const found = section && frame.totals[section.code.key]?.find(([number]) => number === line);
    const of = `of ${toCount(frame.total)} step${frame.total === 1 ? "" : "s"}`;
    const { span, words } = this.#recorded;
    if (span && !section?.code.code.includes(line)) {
      setText(this.#said, words || ((this.#stream.about as LinesAbout).assumes ?? ""));
      return;
    }
    if (!section?.code.code.includes(line)) {
      setText(this.#said, `${toCount(frame.total)} step${frame.total === 1 ? "" : "s"} of this version`);
      return;
    }
    if (span && this.#recorded.chosen === section.code.first + line && words) {
      setText(this.#said, words);
      return;
    }
    const [, reached = 0, isTrue = 0] = found ?? [];
    const name = `line ${section.code.first + line}`;
    const isFlag = section.kinds.get(line) === "flag";
    const how = isFlag
      ? `${name} was true in ${toCount(isTrue)} ${of}, reached in ${toCount(reached)}`
      : `${name} was reached in ${toCount(reached)} ${of}`;
    setText(this.#said, span ? `${how}: click or Enter marks when` : how);
  }

  /** Lights in the robot's laser the rays that the pointed or focused line read. */
  #light(step: Step): void {
    const { section, line } = this.#pointed ?? {};
    if (!section) return;
    const call = step.calls.find(({ key }) => key === section.code.key);
    this.#lit = this.#stream.robot;
    light(this.#lit, toLit(call?.lines.find(([number]) => number === line)));
  }

  #point(target: EventTarget | null): void {
    const element = target instanceof Element ? target.closest(".rw-line") : null;
    const section = this.#sections.find(({ rows }) => rows.some(({ root }) => root === element));
    const line = section?.rows.findIndex(({ root }) => root === element) ?? -1;
    if (section === this.#pointed?.section && line === this.#pointed?.line) return;
    this.#pointed = section ? { section, line } : null;
    if (!section) light(this.#lit, []);
    this.#card.redraw();
  }

  /** Marks in the player when a clicked line was true or reached. */
  #choose(target: EventTarget | null): void {
    if (!this.#recorded.span) return;
    this.#point(target);
    const { section, line = -1 } = this.#pointed ?? {};
    if (section?.code.code.includes(line)) this.#recorded.toggle(section.code.first + line);
  }

  #unpoint(): void {
    if (this.#pointed) light(this.#lit, []);
    this.#pointed = null;
  }

  #onKey(event: KeyboardEvent): void {
    if (!isPlain(event)) return;
    if (STEPS[event.key] && this.#step(STEPS[event.key] ?? 0)) {
      event.preventDefault();
      event.stopPropagation();
    }
    if (this.#recorded.span && this.#onChoice(event)) {
      event.preventDefault();
      event.stopPropagation();
      return;
    }
    const rows = this.#rows;
    const at = rows.indexOf(event.target as HTMLElement);
    const next = rows[at + (MOVES[event.key] ?? 0)];
    if (at < 0 || !MOVES[event.key] || !next) return;
    event.preventDefault();
    event.stopPropagation();
    for (const row of rows) set(row, "tabIndex", row === next ? 0 : -1);
    next.focus();
  }

  /** Marks the spans of the focused line, or no spans; returns false for other keys. */
  #onChoice({ key, target }: KeyboardEvent): boolean {
    if (key === "Escape" && this.#recorded.chosen !== undefined) this.#recorded.toggle(this.#recorded.chosen);
    else if (key === "Enter" && this.#rows.includes(target as HTMLElement)) this.#choose(target);
    else return false;
    return true;
  }

  /** Goes to the next or the previous step of a frozen picture; returns false without one. */
  #step(by: number): boolean {
    const frame = this.#stream.shown;
    if (!this.#stream.paused || !frame) return false;
    void this.#step_;
    const index = this.#at.index + by;
    if (frame.steps[index]) this.#at = { ...this.#at, index };
    else {
      const before = frame.sequence;
      this.#stream.step(by);
      const now = this.#stream.shown;
      if (!now || now.sequence === before) return false;
      this.#at = { sequence: now.sequence, index: by > 0 ? 0 : now.steps.length - 1 };
    }
    this.#card.redraw();
    return true;
  }

  #toggleFold(): void {
    setTraits(this.#model, { folded: !this.#model.get("folded") });
  }
}

/** A function: its lines, and the passes of its loops below these. */
class Section {
  readonly root = make("div", "rw-lines-function");
  readonly rows: Row[];
  readonly code: FunctionCode;
  /** The kinds of levels of lines so far. */
  readonly kinds = new Map<number, string>();
  readonly #why = make("div", "rw-lines-why");
  readonly #loops = new Map<number, HTMLElement>();
  readonly #start: number;

  constructor(code: FunctionCode, isNamed: boolean) {
    this.code = code;
    this.root.role = "rowgroup";
    if (isNamed) this.root.ariaLabel = code.name;
    const lines = new Set(code.code);
    this.rows = code.texts.map((text, i) => new Row(code.first + i, text, lines.has(i)));
    this.#start = Math.max(
      0,
      code.texts.findIndex((text) => /^\s*def\b/.test(text)),
    );
    setText(this.#why, code.why && `${code.name} runs as it is, and shows no values: ${code.why}.`);
    setHidden(this.#why, !code.why);
    this.root.append(this.#why, ...this.rows.map(({ root }) => root));
  }

  update(step: Step, failure: string): void {
    const call = step.calls.find(({ key }) => key === this.code.key);
    // The functions of other states of a state machine are hidden.
    setHidden(this.root, !call && !failure);
    const lines = new Map<number, Line>(call?.lines.map((line) => [line[0], line]));
    const given = step.given.map((pair) => pair.join(" ")).join(" \u00b7 ");
    const [failed, error] = call?.error ?? [-1, ""];
    for (const [i, row] of this.rows.entries()) {
      const line = lines.get(i);
      if (line) this.kinds.set(i, line[4] === "reached" ? (this.kinds.get(i) ?? line[4]) : line[4]);
      const state = line ?? (this.code.code.includes(i) && call ? null : undefined);
      row.update(state, i === failed ? error : "", i === this.#start ? given : "");
    }
    this.#updateLoops(call);
  }

  /** Marks the lines that read the pointed rays, and the line whose spans are marked. */
  mark(step: Step, pointed: PointedRay[], chosen: number | undefined): void {
    const call = step.calls.find(({ key }) => key === this.code.key);
    const read = new Map(call?.lines.map((line) => [line[0], toLit(line)]));
    for (const [i, { root }] of this.rows.entries()) {
      set(root.dataset, "ray", String(pointed.length > 0 && readsOne(read.get(i) ?? [], pointed)));
      set(root, "ariaSelected", chosen === undefined ? null : String(chosen === this.code.first + i));
    }
  }

  /** Shows the passes of loops. They keep their largest height so far, so that nothing jumps. */
  #updateLoops(call: Call | undefined): void {
    for (const [number, element] of this.#loops) {
      if (!call?.loops.some(([line]) => line === number)) element.replaceChildren();
    }
    for (const [number, rows, times] of call?.loops ?? []) {
      let element = this.#loops.get(number);
      if (!element) {
        element = make("div", "rw-line-passes");
        element.role = "row";
        this.#loops.set(number, element);
        this.rows[number]?.root.after(element);
      }
      const texts = [...rows, ...(times > rows.length ? [`\u2026 and ${toCount(times - rows.length)} more`] : [])];
      while (element.children.length > texts.length) element.lastChild?.remove();
      for (const [i, text] of texts.entries()) {
        if (!element.children[i]) {
          const cell = make("span", "");
          cell.role = "cell";
          element.append(cell);
        }
        setText(element.children[i] as HTMLElement, text);
      }
      const seen = Math.max(Number(element.dataset.most ?? 0), texts.length);
      element.dataset.most = String(seen);
      element.style.setProperty("--rw-passes", String(seen));
    }
  }
}

function toLit(line: Line | undefined): Lit[] {
  const [, , , , , , rays = []] = line ?? [];
  return rays.map(([runs, nearest, frame]) => ({ runs, nearest, frame }));
}

/** Returns the return value of a step, for a folded card. */
function summaryOf(step: Step | null, { functions = [] }: VersionCode): string {
  const call = step?.calls.find(({ error }) => error) ?? step?.calls.at(-1);
  const { texts = [], first = 1 } = functions.find(({ key }) => key === call?.key) ?? {};
  if (call?.error) return `line ${first + call.error[0]}: ${call.error[1]}`;
  const last = call?.lines.filter(([number]) => /^\s*return\b/.test(texts[number] ?? "")).at(-1);
  return last ? `line ${first + last[0]}: ${last[1]}` : "";
}
