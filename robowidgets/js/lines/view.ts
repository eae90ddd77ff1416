import { copyText } from "../shared/copy.ts";
import { make, makeButton, set, setHidden, setLabel, setText } from "../shared/dom.ts";
import { isPlain, on, onAbort } from "../shared/events.ts";
import { toCount, toFixed } from "../shared/format.ts";
import { type Lit, light, onPointedRays, type PointedRay, pointedRays, readsOne } from "../shared/lit.ts";
import { type Model, onChange, setTraits } from "../shared/model.ts";
import { SampleCard } from "../shared/sample_card.ts";
import type { Stream } from "../shared/stream.ts";
import { changedLines, editorsOf, replaceIn } from "./cell.ts";
import { NumberChange, type Place } from "./change.ts";
import type { Codes } from "./codes.ts";
import { ComparedTable } from "./compared.ts";
import { drawGraph, SECONDS } from "./graph.ts";
import { Recorded } from "./recorded.ts";
import { Row } from "./row.ts";
import { type Call, type Line, type Step, type Steps, type Trace, tracesOf } from "./steps.ts";
import type { FunctionCode, LinesAbout, LinesTraits, NumberCode, VersionCode } from "./traits.ts";

const STEPS: Record<string, number> = { ",": -1, ".": 1 };
const MOVES: Record<string, number> = { ArrowDown: 1, ArrowUp: -1 };
/** The maximum width of code, in characters, with values next to it. */
const WIDEST = 56;
/** Pixels; a pointer that moves less on a number only shows its slider. */
const DRAG_PX = 3;
/** The keys that change a focused number. Arrows to the left and right go to the next one. */
const UPRIGHT = new Set(["ArrowUp", "ArrowDown", "PageUp", "PageDown"]);

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
  readonly #change: NumberChange;
  readonly #compared: ComparedTable;
  /** The number that a pointer drags, the place of the press, and its text then. */
  #drag: { id: number; x: number; from: string; hasMoved: boolean } | null = null;
  /** The lines that were put into a cell, by function: those that stand there now. */
  readonly #inCells = new Map<string, string[]>();

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
    this.#change = new NumberChange(model, this.#card.redraw, (place) => this.#literalAt(place)?.focus(), signal);
    this.#compared = new ComparedTable(model);
    this.#card.picture.append(this.#recorded.button, this.#table, this.#compared.root, this.#empty);
    this.#card.footer.append(this.#said);
    const { root } = this.#card;
    // Before the listener of the card, which would go from frame to frame and skip the steps between them.
    on(root, "keydown", (event) => this.#onKey(event), signal, { capture: true });
    on(this.#table, "pointerover", ({ target }) => this.#point(target), signal);
    on(this.#table, "pointerleave", () => this.#point(null), signal);
    on(this.#table, "focusin", ({ target }) => this.#point(target), signal);
    on(this.#table, "focusout", () => this.#point(null), signal);
    on(this.#table, "click", ({ target }) => this.#choose(target), signal);
    on(this.#table, "pointerdown", (event) => this.#onDown(event), signal);
    on(this.#table, "pointermove", (event) => this.#onMove(event), signal);
    on(this.#table, "pointerup", (event) => this.#onUp(event), signal);
    for (const type of ["pointercancel", "lostpointercapture"] as const) {
      on(this.#table, type, (event) => this.#drag?.id === event.pointerId && this.#cancelDrag(), signal);
    }
    onPointedRays(this.#card.redraw, signal);
    onChange(model, ["_code", "folded", "_drive", "_chosen", "_offer", "_compared"], this.#card.redraw, signal);
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
    let step = this.#step_;
    const { mode = "running", version, failure = "" } = this.#stream.about as LinesAbout;
    const isFolded = this.#model.get("folded");
    const { paused } = this.#stream;
    const newest = this.#model.get("_code");
    // A version that has made no step yet, such as while Stop is active, is shown without values.
    const isAhead = mode === "replaced" && !paused && newest.key !== frame?.key;
    const code = isAhead ? newest : this.#codes.of(frame?.key);
    const { span } = this.#recorded;
    this.#card.canFreeze = !span;
    this.#recorded.drawButton();
    // A function of samples has no steps before the one on show.
    const number = step?.number ? [`step ${toCount(step.number)}`] : [];
    const time = step && (step.calls.length || !span) ? [`${toFixed(step.time, 2)} s`] : [];
    const facts = step && !isAhead ? [...number, ...time] : [];
    if (step && isAhead) step = { ...step, calls: [], given: [] };
    const said =
      mode === "running" ? "" : mode !== "replaced" ? mode : isAhead ? "no step yet" : "a newer version is in force";
    this.#card.update(
      [
        version ? `v${code.version ?? version}` : "",
        ...facts,
        said,
        isFolded ? summaryOf(step, code, span ? "" : ", keeps its speed") : "",
      ],
      "step",
      false,
    );
    set(this.#card.root.dataset, "folded", String(isFolded));
    set(this.#fold, "ariaExpanded", String(!isFolded));
    setLabel(this.#fold, isFolded ? "Show the lines" : "Show one line only");
    for (const button of [this.#back, this.#next]) setHidden(button, !paused || !this.#stream.place);
    setHidden(this.#empty, step !== null);
    setHidden(this.#table, !step);
    if (!step || isFolded) setHidden(this.#compared.root, true);
    setText(this.#empty, this.#card.waiting("step"));
    this.#card.picture.style.paddingTop = `${this.#card.noticeHeight}px`;
    if (!frame || !step || isFolded) {
      this.#unpoint();
      return;
    }
    if (code !== this.#shown) this.#build(code);
    this.#drawChange();
    this.#compared.draw(code.key ?? "");
    const rays = pointedRays(this.#stream.robot);
    const { chosen } = this.#recorded;
    for (const section of this.#sections) {
      section.update(step, failure || ((span || isAhead) && this.#sections.length === 1 ? "-" : ""));
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
    const focused = (this.#card.root.getRootNode() as Document | ShadowRoot).activeElement;
    const isOnLiteral =
      focused !== null && this.#change.place !== null && focused === this.#literalAt(this.#change.place);
    const isInChange = this.#change.root.contains(focused);
    this.#sections = functions.map((one) => {
      const section = new Section(one, functions.length > 1, () => this.#putIntoCell(section));
      if (one.changed && this.#inCells.get(one.name)?.join() === one.changed.join()) section.sayInCell();
      return section;
    });
    this.#table.ariaLabel = `lines of ${code.name ?? "the program"}`;
    const longest = Math.max(0, ...functions.flatMap(({ texts }) => texts.map(({ length }) => length)));
    this.#table.style.setProperty("--rw-code-width", `${Math.min(WIDEST, longest) + 1}ch`);
    this.#table.replaceChildren(...this.#sections.map(({ root }) => root));
    const [first] = this.#rows;
    if (first) this.#rove(first);
    this.#followChange();
    if (isInChange) (focused as HTMLElement).focus({ preventScroll: true });
    if (isOnLiteral && this.#change.place) this.#literalAt(this.#change.place)?.focus({ preventScroll: true });
  }

  /** Lets Tab reach one row, and its numbers. */
  #rove(to: HTMLElement): void {
    for (const { rows } of this.#sections) {
      for (const { root, literals } of rows) {
        for (const element of [root, ...literals.map((literal) => literal.element)]) {
          set(element, "tabIndex", root === to ? 0 : -1);
        }
      }
    }
  }

  // -- numbers that are changed ---------------------------------------------------------------------------------------

  /** The place of a number that can be changed now; null for other elements. */
  #placeOf(target: EventTarget | null): Place | null {
    const { key = "" } = this.#shown ?? {};
    if (!(target instanceof Element) || key !== this.#model.get("_code").key) return null;
    for (const { code, rows } of this.#sections) {
      for (const [line, { literals }] of rows.entries()) {
        const index = literals.findIndex(({ element }) => element === target);
        const [, column, text] = literals[index]?.number ?? [];
        if (column === undefined || text === undefined) continue;
        return { key, function: code.key, name: code.name, line, column, index, text };
      }
    }
    return null;
  }

  #rowAt({ name, line }: Place): Row | undefined {
    return this.#sections.find(({ code }) => code.name === name)?.rows[line];
  }

  #literalAt(place: Place): HTMLElement | undefined {
    return this.#rowAt(place)?.literals[place.index]?.element;
  }

  #isOpenAt(target: EventTarget | null): boolean {
    const { place } = this.#change;
    return place !== null && target === this.#literalAt(place);
  }

  #open(place: Place): void {
    this.#change.open(place);
    this.#rowAt(place)?.root.after(this.#change.root);
  }

  /** Finds the number that is changed in another version of the source. */
  #followChange(): void {
    const { place } = this.#change;
    if (!place) return;
    const found = this.#placeOf(this.#literalAt(place) ?? null);
    if (!found) {
      this.#change.close();
      return;
    }
    this.#change.moveTo(found);
    this.#rowAt(found)?.root.after(this.#change.root);
  }

  #drawChange(): void {
    const { place, shown } = this.#change;
    for (const { rows } of this.#sections) {
      for (const row of rows) for (const index of row.literals.keys()) row.show(index, null);
    }
    if (!place) return;
    this.#rowAt(place)?.show(place.index, shown);
    this.#change.draw(this.#card.theme, this.#card.size.ratio);
  }

  #onDown(event: PointerEvent): void {
    const place = event.button === 0 ? this.#placeOf(event.target) : null;
    if (!place) return;
    event.preventDefault(); // no selection of text
    const element = event.target as HTMLElement;
    element.focus({ preventScroll: true });
    this.#open(place);
    element.setPointerCapture(event.pointerId);
    this.#drag = { id: event.pointerId, x: event.clientX, from: place.text, hasMoved: false };
  }

  #onMove({ pointerId, clientX }: PointerEvent): void {
    if (this.#drag?.id !== pointerId) return;
    const moved = clientX - this.#drag.x;
    this.#drag.hasMoved ||= Math.abs(moved) >= DRAG_PX;
    if (this.#drag.hasMoved) this.#change.drag(this.#drag.from, moved);
  }

  #onUp({ pointerId }: PointerEvent): void {
    if (this.#drag?.id !== pointerId) return;
    const { hasMoved } = this.#drag;
    this.#drag = null;
    if (hasMoved) this.#change.put();
  }

  #cancelDrag(): void {
    this.#drag = null;
    this.#change.close();
  }

  /** Handles keys on a number and on its slider; returns false for other keys. */
  #onNumberKey({ key, target }: KeyboardEvent): boolean {
    const { slider, root } = this.#change;
    if (root.contains(target as Node)) {
      if (target !== slider && key !== "Escape") return false;
      return this.#change.onKey(key, () => true);
    }
    const place = this.#placeOf(target);
    if (key === "Escape" && this.#isOpenAt(target)) {
      this.#drag = null;
      this.#change.escape();
      return true;
    }
    if (!place) return false;
    const { literals = [], root: row } = this.#rowAt(place) ?? {};
    if (key === "ArrowLeft" || key === "ArrowRight") {
      const next = literals[place.index + (key === "ArrowLeft" ? -1 : 1)]?.element;
      (next ?? (key === "ArrowLeft" ? row : undefined))?.focus();
      return true;
    }
    if (key !== "Enter" && !UPRIGHT.has(key)) return false;
    if (!this.#isOpenAt(target)) this.#open(place);
    if (key === "Enter" && this.#change.shown === place.text) slider.focus();
    else this.#change.onKey(key, (one) => UPRIGHT.has(one));
    return true;
  }

  /** Puts the changed lines of a function into its cell, or copies them. */
  async #putIntoCell(section: Section): Promise<void> {
    const { name, cell = [], changed = [] } = section.code;
    const editors = editorsOf(document);
    const befores = [this.#inCells.get(name) ?? cell, cell, changed];
    const why = replaceIn(editors, befores, changed);
    if (!why) {
      this.#inCells.set(name, changed);
      section.sayInCell();
      return;
    }
    const isCopied = await copyText(changedLines(cell, changed));
    section.sayOfCell(
      isCopied
        ? `copied, because ${why}: paste it over the line in the cell that you ran`
        : `not copied: the clipboard cannot be reached, and ${why}. Type it into the cell`,
    );
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
    if (this.#onNumberKey(event)) {
      event.preventDefault();
      event.stopPropagation();
      return;
    }
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
    const first =
      event.key === "ArrowRight" && at >= 0 ? rows[at]?.querySelector<HTMLElement>(".rw-line-literal") : null;
    if (first) {
      event.preventDefault();
      event.stopPropagation();
      first.focus();
      return;
    }
    const next = rows[at + (MOVES[event.key] ?? 0)];
    if (at < 0 || !MOVES[event.key] || !next) return;
    event.preventDefault();
    event.stopPropagation();
    this.#rove(next);
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
  readonly #cell = make("div", "rw-lines-cell");
  readonly #cellWords = make("span", "");
  readonly #put = make("button", "rw-button rw-lines-put", "Put into the cell");
  readonly #start: number;

  /** @param putIntoCell called when the changed lines are to be put into the cell */
  constructor(code: FunctionCode, isNamed: boolean, putIntoCell: () => void) {
    this.code = code;
    this.root.role = "rowgroup";
    if (isNamed) this.root.ariaLabel = code.name;
    const lines = new Set(code.code);
    this.rows = code.texts.map((text, i) => new Row(code.first + i, text, lines.has(i), numbersIn(code, i)));
    this.#start = Math.max(
      0,
      code.texts.findIndex((text) => /^\s*def\b/.test(text)),
    );
    setText(this.#why, code.why && `${code.name} runs as it is, and shows no values: ${code.why}.`);
    setHidden(this.#why, !code.why);
    this.root.append(this.#why, ...this.rows.map(({ root }) => root), this.#cell);
    setHidden(this.#cell, !code.changed);
    if (code.changed) this.#offerCell(putIntoCell);
  }

  #offerCell(onClick: () => void): void {
    const { first, cell = [], changed = [] } = this.code;
    const lines = changed.flatMap((text, i) => (text === cell[i] ? [] : [first + i]));
    setText(this.#cellWords, `${lines.length > 1 ? "lines" : "line"} ${lines.join(", ")}: not as in the cell`);
    this.#cellWords.role = "status";
    this.#put.type = "button";
    this.#put.addEventListener("click", onClick);
    this.#cell.append(this.#cellWords, this.#put);
  }

  /** Shows that the changed lines are in the cell. */
  sayInCell(): void {
    this.#put.disabled = true;
    this.sayOfCell("in the cell now; the robot has this version already");
  }

  /** Shows what became of the lines that were to be put into the cell. */
  sayOfCell(words: string): void {
    setText(this.#cellWords, words);
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

function numbersIn({ numbers = [] }: FunctionCode, line: number): NumberCode[] {
  return numbers.filter(([number]) => number === line);
}

function toLit(line: Line | undefined): Lit[] {
  const [, , , , , , rays = []] = line ?? [];
  return rays.map(([runs, nearest, frame]) => ({ runs, nearest, frame }));
}

/**
 * Returns the return value of a step, for a folded card.
 * @param keeps the effect of None
 */
function summaryOf(step: Step | null, { functions = [] }: VersionCode, keeps: string): string {
  const call = step?.calls.find(({ error }) => error) ?? step?.calls.at(-1);
  const { texts = [], first = 1 } = functions.find(({ key }) => key === call?.key) ?? {};
  if (call?.error) return `line ${first + call.error[0]}: ${call.error[1]}`;
  if (call && step?.none) return `returned None${keeps}`;
  const last = call?.lines.filter(([number]) => /^\s*return\b/.test(texts[number] ?? "")).at(-1);
  return last ? `line ${first + last[0]}: ${last[1]}` : "";
}
