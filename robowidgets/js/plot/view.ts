import type { Point } from "../shared/box.ts";
import { Canvas, type Context, circle, fill, line, stroke, write } from "../shared/canvas.ts";
import { Card } from "../shared/card.ts";
import { make, makeButton, makeIcon, PAUSE, PLAY, set, setHidden, setLabel, setText, zoomOf } from "../shared/dom.ts";
import { isPlain, on, onAbort } from "../shared/events.ts";
import { toFixed, toMany } from "../shared/format.ts";
import { describeMark, markBeside } from "../shared/marks.ts";
import { lacksKernel, type Model, NO_KERNEL, onChange, setTraits } from "../shared/model.ts";
import { offerPng } from "../shared/png.ts";
import { perAnimationFrame } from "../shared/schedule.ts";
import { StateBand } from "../shared/states/band.ts";
import { cutName, nameOf, statesAt } from "../shared/states/states.ts";
import { textFont } from "../shared/theme.ts";
import { type Span, type TimeAxis, toTime, toX } from "../shared/time_axis.ts";
import { watchGestures } from "../shared/time_gestures.ts";
import { moved, toMoment, zoomed } from "../shared/time_span.ts";
import type { Pointing } from "../shared/traits.ts";
import { Adder } from "./adder.ts";
import { Chart, SCALE, type Shown, TIMES } from "./chart.ts";
import type { PlotData } from "./data.ts";
import { type Entry, type Group, isDrawn, toGroups } from "./groups.ts";
import { Legend, type More, toValue, type Values } from "./legend.ts";
import type { PlotMember } from "./member.ts";
import { holding, spread } from "./names.ts";
import { measure, readingAt, timeBeside } from "./rows.ts";
import { follows, type Looking, seen, wholeOf } from "./span.ts";
import type { PlotTraits } from "./traits.ts";
import { type Axis, drawPairs, drawRing, type Pairs, Projection, timeNear, toPairs } from "./xy.ts";

/** Width of a card from which the legend stands next to the graphs. */
const WIDE = 640;
const [LEAST_GRAPH, ONE_GRAPH, GRAPH] = [110, 230, 160];
/** Pixels right of the lines: with names if there is room. */
const [RIGHT, NAMES] = [14, 96];
/** Width of a picture from which names stand at the ends of its lines. */
const NAMED = 440;
const ONE_OVER_OTHER = 320;
/** Least seconds on show. */
const SHORTEST = 1e-4;
const LATE = "finer detail when the kernel is free";
const HINT = "least, mean and most are of this";
/** Conditions that are listed below the lines. */
const MOST_MARKS = 3;
const NEVER = `no finer detail: ${NO_KERNEL}`;

/** One view of a plot: it wires the card, the graphs, the legend and the gestures together. */
export class PlotView {
  readonly #model: Model<PlotTraits & Pointing>;
  readonly #member: PlotMember;
  readonly #data: PlotData;
  readonly #card: Card;
  readonly #graphs = make("div", "rw-plot-graphs");
  readonly #top: Canvas;
  readonly #legend: Legend;
  readonly #states: StateBand;
  readonly #adder: Adder;
  readonly #over: HTMLButtonElement;
  readonly #shift = make("label", "rw-plot-shift");
  readonly #seconds = make("input", "rw-field");
  readonly #empty = make("div", "rw-empty");
  readonly #span = make("span", "");
  readonly #fact = make("span", "");
  readonly #freeze: HTMLButtonElement;
  readonly #follow: HTMLButtonElement;
  readonly #all: HTMLButtonElement;
  readonly #redrawTop: () => void;
  #charts: Chart[] = [];
  #groups: Group[] = [];
  #built = "";
  /** The line that keys picked, or null. */
  #picked: string | null = null;
  /** The time under the pointer on the states; null if it is elsewhere. */
  #onStates: number | null = null;
  #pairs: { key: unknown[]; pairs: Pairs } | null = null;
  #projection: Projection | null = null;
  #pointer: Point | null = null;
  #draft: Span | null = null;

  constructor(
    model: Model<PlotTraits & Pointing>,
    element: HTMLElement,
    data: PlotData,
    member: PlotMember,
    signal: AbortSignal,
  ) {
    this.#model = model;
    this.#data = data;
    this.#member = member;
    this.#redrawTop = perAnimationFrame(() => this.#drawTop(), signal);
    this.#card = new Card(element, "plot", model, () => this.#draw(), signal);
    const { picture, controls, footer, root } = this.#card;
    // Screen readers leave the arrow keys to it.
    picture.role = "application";
    picture.append(this.#graphs);
    this.#top = new Canvas(picture);
    picture.append(this.#empty);
    this.#legend = new Legend(
      { onPoint: (name) => this.#light(name ?? this.#picked), onSwitch: (name) => this.#switch(name) },
      signal,
    );
    const onPick = (time: number) => setTraits(model, { time });
    const onPoint = (time: number | null) => {
      this.#onStates = time;
      this.#tellPointed(time);
      this.#redrawTop();
    };
    this.#states = new StateBand("rw-plot-states", SCALE, { onPick, onPoint }, () => this.#drawTop(), signal);
    this.#adder = new Adder((add) => model.send({ add }), signal);
    picture.after(this.#states.root, this.#legend.root);
    this.#card.header.after(this.#adder.panel);
    footer.append(this.#span, this.#fact);
    const closer = makeButton("rw-zoom", "Zoom in (+)", () => this.onZoom(0.5, null), signal, "+");
    const farther = makeButton("rw-zoom", "Zoom out (\u2212)", () => this.onZoom(2, null), signal, "\u2212");
    this.#all = makeButton("", "Show all of it (0, double click)", () => this.onReset(), signal, "All");
    const toNewest = () => setTraits(model, { view: null, window: model.get("window") ?? 30 });
    this.#follow = makeButton("", "Follow the newest values", toNewest, signal, "Newest");
    this.#freeze = makeButton("rw-plot-freeze", "", () => member.toggle(), signal);
    this.#over = makeButton("rw-plot-over", "", () => this.#toggleOver(), signal, "x over y");
    this.#seconds.type = "number";
    this.#seconds.step = "0.1";
    this.#shift.append("shift", this.#seconds, "s");
    on(this.#seconds, "change", () => setTraits(model, { shift: Number(this.#seconds.value) || 0 }), signal);
    on(this.#seconds, "keydown", (event) => event.stopPropagation(), signal);
    controls.append(
      this.#shift,
      this.#adder.button,
      this.#over,
      this.#follow,
      farther,
      closer,
      this.#all,
      this.#freeze,
    );
    offerPng(this.#card, model, signal);
    onChange(
      model,
      ["_lines", "_detail", "_facts", "units", "view", "window", "marks", "states", "steps", "off", "ghosts", "shift"],
      this.#card.redraw,
      signal,
    );
    onChange(model, ["x_over_y", "_choices", "paused", "_frozen_at"], this.#card.redraw, signal);
    onChange(model, ["time", "_moment"], this.#redrawTop, signal);
    watchGestures(picture, this, signal);
    on(root, "keydown", (event) => this.#onKey(event), signal);
    onAbort(signal, () => this.#close());
  }

  onHover(point: Point | null): void {
    this.#pointer = point;
    this.#tellPointed(point && this.#timeAt(point));
    this.#redrawTop();
  }

  onPress(): void {}

  onPick(point: Point): void {
    const time = this.#timeAt(point);
    if (time !== null) setTraits(this.#model, { time });
  }

  onSelect(from: Point, to: Point, _rays: boolean, done: boolean): void {
    const axis = this.#axis;
    if (!axis || this.#projection) return;
    const times = [from, to].map(({ x }) => toTime(axis, x));
    this.#draft = done ? null : [Math.min(...times), Math.max(...times)];
    const [start, end] = [Math.min(...times), Math.max(...times)];
    if (done && end - start > SHORTEST) setTraits(this.#model, { view: [start, end] });
    this.#redrawTop();
  }

  onCancel(): void {
    this.#draft = null;
    this.#redrawTop();
  }

  onPan(pixels: number): void {
    const { axis, looking } = { axis: this.#axis, looking: this.#looking };
    if (!axis || !looking) return;
    this.#look(moved(axis.span, (pixels / axis.width) * lengthOf(axis.span), wholeOf(looking)));
  }

  canZoom(factor: number): boolean {
    const looking = this.#looking;
    if (!looking) return false;
    return factor < 1 ? lengthOf(seen(looking)) > SHORTEST : lengthOf(seen(looking)) < lengthOf(wholeOf(looking));
  }

  onZoom(factor: number, point: Point | null): void {
    const { axis, looking } = { axis: this.#axis, looking: this.#looking };
    if (!axis || !looking) return;
    const whole = wholeOf(looking);
    if (follows(looking)) {
      const length = Math.max(SHORTEST, lengthOf(axis.span) * factor);
      setTraits(this.#model, { window: length < lengthOf(whole) ? length : null });
      return;
    }
    const time = this.#model.get("time") ?? NaN;
    const middle = time >= axis.span[0] && time <= axis.span[1] ? time : (axis.span[0] + axis.span[1]) / 2;
    const around = point && !this.#projection ? toTime(axis, point.x) : middle;
    this.#look(zoomed(axis.span, factor, around, whole, SHORTEST));
  }

  onReset(): void {
    setTraits(this.#model, { view: null, window: null });
  }

  onClear(): void {
    setTraits(this.#model, { time: null });
  }

  /** Goes to the next or the previous value of any line. */
  onStep(by: number): void {
    const looking = this.#looking;
    if (!looking) return;
    const [first, last] = wholeOf(looking);
    if (!Number.isFinite(by)) {
      this.#goTo(by < 0 ? first : last);
      return;
    }
    const from = this.#model.get("time") ?? seen(looking)[by > 0 ? 0 : 1];
    const picked = this.#entries.find(({ name }) => name === this.#picked);
    const lines = picked ? [this.#data.lines[picked.index] ?? []].flat() : this.#data.lines;
    const times = lines.flatMap((rows) => timeBeside(rows, from, by) ?? []).filter((time) => time <= last);
    if (times.length) this.#goTo(by > 0 ? Math.min(...times) : Math.max(...times));
  }

  onMark(direction: -1 | 1): void {
    const looking = this.#looking;
    const from = this.#model.get("time") ?? (looking ? seen(looking)[0] : 0);
    const time = markBeside(this.#model.get("marks"), from, direction);
    if (time !== undefined) this.#goTo(time);
  }

  get #looking(): Looking | null {
    const whole = this.#data.whole;
    const model = this.#model;
    const frozenAt = model.get("paused") ? model.get("_frozen_at") : null;
    const live = model.get("_facts").live ?? false;
    return whole && { whole, view: model.get("view"), live, window: model.get("window"), frozenAt };
  }

  /** The axis of times in the picture. */
  get #axis(): TimeAxis | null {
    const looking = this.#looking;
    const box = this.#charts[0]?.box;
    return looking && box ? { span: seen(looking), left: box.left, width: Math.max(1, box.width) } : null;
  }

  #look(span: Span): void {
    const looking = this.#looking;
    const isAll = looking !== null && !looking.live && lengthOf(span) >= lengthOf(wholeOf(looking)) * (1 - 1e-9);
    setTraits(this.#model, { view: isAll ? null : span });
  }

  /** Moves the cursor, and the view if the cursor would leave it. */
  #goTo(time: number): void {
    const looking = this.#looking;
    if (!looking) return;
    setTraits(this.#model, { time });
    const span = seen(looking);
    if (time < span[0] || time > span[1]) this.#look(moved(span, time - (span[0] + span[1]) / 2, wholeOf(looking)));
    const units = this.#model.get("units");
    const values = this.#entries.map(({ name, label, index }) => {
      const rows = this.#data.lines[index];
      const reading = rows ? readingAt(rows, time) : null;
      const measures = rows ? measure(rows, span) : null;
      return `${label} ${reading ? toValue(reading.value, measures) : "no value"} ${units[name] ?? ""}`.trim();
    });
    const mark = this.#model.get("marks").length ? describeMark(this.#model.get("marks"), time).label : "";
    const states = statesAt(this.#model.get("states"), time).map(([, , path]) => nameOf(path));
    this.#card.say([`${time.toFixed(3)} s`, ...values, mark, ...states]);
  }

  #onKey(event: KeyboardEvent): void {
    if (!isPlain(event) || event.target instanceof HTMLButtonElement || event.target instanceof HTMLInputElement)
      return;
    const names = this.#entries.map(({ name }) => name);
    const at = names.indexOf(this.#picked ?? "");
    if (event.key === " ") this.#member.toggle();
    else if (event.key === "[" || event.key === "]") {
      // After the last comes null, which stands for all.
      const next = at + (event.key === "]" ? 1 : -1);
      this.#pick(names[next < -1 ? names.length - 1 : next] ?? null);
    } else if (event.key === "Delete" && this.#picked !== null) {
      const name = this.#picked;
      this.#pick(null);
      if (lacksKernel(this.#model)) this.#switch(name);
      else this.#model.send({ take_out: name });
    } else return;
    event.preventDefault();
  }

  /** Picks a line, whose values arrow keys visit; null for the values of all lines. */
  #pick(name: string | null): void {
    this.#picked = name;
    this.#light(name);
    this.#card.say([name ?? "all lines"]);
  }

  #light(name: string | null): void {
    for (const chart of this.#charts) chart.light(name);
  }

  /** Leaves a line out, or draws it again. */
  #switch(name: string): void {
    const off = this.#model.get("off");
    setTraits(this.#model, { off: off.includes(name) ? off.filter((one) => one !== name) : [...off, name] });
  }

  /** Draws the second line over the first, or over the one that is picked; or all over time again. */
  #toggleOver(): void {
    const names = this.#entries.map(({ name }) => name);
    const first = names.includes(this.#picked ?? "") ? (this.#picked as string) : names[0];
    const second = names.find((name) => name !== first);
    const isOver = this.#model.get("x_over_y") !== null;
    setTraits(this.#model, { x_over_y: isOver || !first || !second ? null : [first, second] });
  }

  /** Publishes the time under the pointer, which a player shows in all its widgets. */
  #tellPointed(time: number | null): void {
    const before = this.#model.get("_pointed");
    if (before?.time !== time && (before || time !== null)) {
      this.#model.set("_pointed", time === null ? null : { time, ray: null });
    }
  }

  /** The time at a place of the picture; null if it is outside of the axis. */
  #timeAt(point: Point): number | null {
    const axis = this.#axis;
    if (this.#projection && this.#pairs) return timeNear(this.#pairs.pairs, this.#projection, point);
    return axis && point.x >= axis.left ? toTime(axis, point.x) : null;
  }

  /** The lines that are drawn. */
  get #entries(): Entry[] {
    return this.#groups.flatMap(({ entries }) => entries.filter(({ left }) => !left));
  }

  #draw(): void {
    const { names = [], error = "", missed = "", live = false } = this.#model.get("_facts");
    const [units, off, ghosts, steps] = [
      this.#model.get("units"),
      this.#model.get("off"),
      this.#model.get("ghosts"),
      this.#model.get("steps"),
    ];
    const groups = toGroups(names, { units, off, ghosts, steps });
    const { lines } = this.#data;
    this.#card.updateFrame(error ? [error] : [], "error");
    const count = lines.reduce((sum, { total }) => sum + total, 0);
    const facts = names.length ? [toMany(names.length, "line"), toMany(count, "value"), missed] : [missed];
    this.#card.updateFacts(facts.filter(Boolean));
    this.#updateButtons(live);
    this.#adder.update(lacksKernel(this.#model) ? [] : this.#model.get("_choices"), names);
    setHidden(this.#shift, !ghosts.length || lacksKernel(this.#model));
    if (document.activeElement !== this.#seconds) this.#seconds.value = String(this.#model.get("shift"));
    const looking = this.#looking;
    setText(this.#empty, lacksKernel(this.#model) ? NO_KERNEL : "waiting for values");
    setHidden(this.#empty, looking !== null);
    this.#card.root.classList.toggle("rw-plot-wide", this.#card.width >= WIDE);
    // Until the lines of these names are there, such as right after a line was added.
    const isWhole = looking !== null && lines.length === names.length;
    if (isWhole || !names.length) this.#drawGraphs(isWhole ? groups : [], looking);
    this.#drawTop();
  }

  #updateButtons(live: boolean): void {
    const paused = this.#model.get("paused");
    const view = this.#model.get("view");
    setHidden(this.#freeze, !live);
    set(this.#freeze, "ariaPressed", String(paused));
    setLabel(this.#freeze, paused ? "Show the newest again (space)" : "Freeze the picture (space)");
    if (this.#freeze.dataset.state !== String(paused)) {
      this.#freeze.dataset.state = String(paused);
      this.#freeze.replaceChildren(makeIcon(paused ? PLAY : PAUSE), make("span", "", paused ? "Frozen" : "Freeze"));
    }
    setHidden(this.#follow, !live || (view === null && this.#model.get("window") !== null));
    const isOver = this.#model.get("x_over_y") !== null;
    setHidden(this.#over, !isOver && this.#entries.length < 2);
    set(this.#over, "ariaPressed", String(isOver));
    setLabel(this.#over, isOver ? "Draw all lines over time again" : "Draw the second line over the first");
    set(this.#all, "disabled", view === null && (!live || this.#model.get("window") === null));
    this.#card.root.classList.toggle("rw-frozen", paused);
  }

  #drawGraphs(groups: Group[], looking: Looking | null): void {
    const { size, theme, picture, noticeHeight } = this.#card;
    this.#groups = groups;
    const drawn = groups
      .map(({ unit, entries }) => ({ unit, entries: entries.filter(({ left }) => !left) }))
      .filter(isDrawn);
    const over = this.#axes;
    setHidden(this.#graphs, over !== null);
    const count = Math.max(1, drawn.length);
    const graph = count === 1 ? ONE_GRAPH : GRAPH;
    const wanted = over ? ONE_OVER_OTHER : count * graph + TIMES;
    picture.style.setProperty("--rw-plot-height", `${wanted + noticeHeight}px`);
    const least = over ? ONE_OVER_OTHER / 2 : count * LEAST_GRAPH;
    picture.style.setProperty("--rw-plot-least", `${least + TIMES + noticeHeight}px`);
    this.#graphs.style.top = `${noticeHeight}px`;
    const height = Math.max(LEAST_GRAPH * count, size.height - noticeHeight);
    const key = JSON.stringify([groups, theme.font]);
    const right = this.#right;
    const toShown = ({ entries }: Group, i: number): Shown => ({
      rows: entries.flatMap(({ index }) => this.#data.lines[index] ?? []),
      span: looking ? seen(looking) : [0, 1],
      end: looking ? wholeOf(looking)[1] : 1,
      marks: this.#model.get("marks"),
      theme,
      width: size.width,
      height: Math.floor((height - TIMES) / count) + (i === count - 1 ? TIMES : 0),
      right,
    });
    if (key !== this.#built) {
      this.#built = key;
      this.#close();
      this.#legend.build(groups);
      this.#charts = drawn.map(
        (group, i) => new Chart(this.#graphs, group, i === 0, i === drawn.length - 1, toShown(group, i)),
      );
      this.#light(this.#picked);
    }
    this.#states.root.style.marginRight = `${right}px`;
    setHidden(this.#legend.root, !groups.length);
    for (const [i, chart] of this.#charts.entries()) chart.draw(toShown(chart.group, i));
    if (looking && groups.length) this.#askFor(looking);
  }

  /** Pixels right of the lines. */
  get #right(): number {
    return this.#card.size.width >= NAMED ? NAMES : RIGHT;
  }

  /** The two lines of which one is drawn over the other, or null. */
  get #axes(): [Axis, Axis] | null {
    const wanted = this.#model.get("x_over_y") ?? [];
    const all = this.#groups.flatMap(({ unit, entries }) => entries.map((entry) => ({ ...entry, unit })));
    const [one, other] = wanted.map((name) => all.find((entry) => entry.name === name));
    return one && other ? [one, other] : null;
  }

  /** Requests the data of the span on show that the page lacks. */
  #askFor(looking: Looking): void {
    const span = seen(looking);
    const ratio = devicePixelRatio * zoomOf(this.#card.picture);
    const columns = Math.max(1, Math.round((this.#card.size.width - SCALE - this.#right) * ratio));
    const isFine = !this.#data.lacks(span, columns);
    const wanted = follows(looking) ? [] : [...span, columns];
    const isAlone = lacksKernel(this.#model);
    const isHint = isFine || follows(looking);
    setText(this.#fact, isHint ? HINT : isAlone ? NEVER : LATE);
    this.#fact.classList.toggle("rw-plot-hint", isHint);
    const isAsked = this.#model.get("_wanted").join() === wanted.join();
    if (!isAlone && !isAsked && (!wanted.length || !isFine)) setTraits(this.#model, { _wanted: wanted });
  }

  /** Draws the parts that move with the pointer, and the values there. */
  #drawTop(): void {
    const { size, theme, noticeHeight } = this.#card;
    const context = this.#top.begin(size);
    const { axis, looking } = { axis: this.#axis, looking: this.#looking };
    this.#projection = null;
    if (!axis || !looking || !this.#groups.length) return;
    const over = this.#axes;
    if (over) this.#drawOver(context, over, axis.span);
    const [first, last] = wholeOf(looking);
    const pointed = this.#pointer ? this.#timeAt(this.#pointer) : this.#onStates;
    const picked = this.#model.get("_moment") ?? this.#model.get("time");
    const time = pointed ?? picked ?? Math.min(last, axis.span[1]);
    const isShown = (pointed ?? picked) !== null && time >= axis.span[0] && time <= axis.span[1];
    const { lines } = this.#data;
    this.#states.update(this.#model.get("states"), axis.span, (pointed ?? picked) === null ? NaN : time, theme);
    this.#updateMore(time, axis.span, (pointed ?? picked) !== null);
    const values: Values[] = lines.map((rows) => ({
      reading: readingAt(rows, time),
      measures: measure(rows, [Math.max(first, axis.span[0]), Math.min(last, axis.span[1])]),
    }));
    this.#legend.update(values);
    const font = textFont(theme);
    if (over) {
      if (isShown) this.#drawMoment(context, over, values, toMoment(time, last, 3));
      const [from, to] = axis.span.map((one) => toMoment(one, last));
      setText(this.#span, `seen ${from} to ${to}`);
      return;
    }
    for (const chart of this.#charts) {
      const { left, top, height } = chart.box;
      write(context, chart.group.unit, left, top - 11, theme.muted, font, "left");
      if (this.#draft) {
        const [from, to] = this.#draft.map((one) => toX(axis, one)) as Span;
        context.globalAlpha = 0.15;
        context.fillStyle = theme.pointer;
        context.fillRect(from, top, to - from, height);
        context.globalAlpha = 1;
      }
      if (this.#right === NAMES) this.#drawNames(context, chart, values, looking, axis);
      if (!isShown) continue;
      const x = toX(axis, time);
      context.beginPath();
      line(context, { x, y: top }, { x, y: top + height });
      stroke(context, theme.ink, 1.5);
      for (const { index } of chart.group.entries) {
        const reading = values[index]?.reading;
        if (!reading || Number.isNaN(reading.value) || reading.time < axis.span[0]) continue;
        circle(context, { x: toX(axis, reading.time), y: chart.toY(reading.value) }, 4);
        fill(context, theme.background);
        stroke(context, theme.pointer, 2);
      }
    }
    if (isShown) {
      const text = toMoment(time, last, 3);
      const half = 34;
      // After the unit of the first graph, which stands at the left end of the same line.
      context.font = font;
      const unit = context.measureText(this.#charts[0]?.group.unit ?? "").width;
      const x = Math.min(size.width - half, Math.max(axis.left + unit + half, toX(axis, time)));
      write(context, text, x, noticeHeight + 10, theme.ink, `600 ${font}`, "center", theme.background);
    }
    const [from, to] = axis.span.map((one) => toMoment(one, last));
    setText(this.#span, `seen ${from} to ${to}`);
  }

  /** Writes the names of lines at their ends, apart from each other. */
  #drawNames(context: Context, chart: Chart, values: Values[], looking: Looking, axis: TimeAxis): void {
    const { theme } = this.#card;
    const { top, height } = chart.box;
    const end = Math.min(wholeOf(looking)[1], axis.span[1]);
    const entries = chart.group.entries.flatMap((entry) => {
      const rows = this.#data.lines[entry.index];
      const reading = rows && values[entry.index] ? readingAt(rows, end) : null;
      return reading && !Number.isNaN(reading.value) ? [{ entry, y: chart.toY(reading.value) }] : [];
    });
    const heights = entries.map(({ y }) => y);
    const places = spread(heights, 15, top + 6, top + height - 6);
    const left = axis.left + axis.width;
    const font = textFont(theme);
    for (const [i, { entry, y }] of entries.entries()) {
      const place = places[i] as number;
      const from = Math.min(left, toX(axis, end));
      context.beginPath();
      line(context, { x: from + 2, y }, { x: left + 10, y: place });
      stroke(context, theme.guide, 1);
      const label = cutName(context, entry.label, NAMES - 18, theme);
      write(
        context,
        label,
        left + 13,
        place,
        entry.isGhost ? theme.muted : theme.ink,
        i ? font : `600 ${font}`,
        "left",
      );
    }
  }

  /** Draws one line over the other. */
  #drawOver(context: Context, over: [Axis, Axis], span: Span): void {
    const { size, theme, noticeHeight } = this.#card;
    const rows = over.map(({ index }) => this.#data.lines[index]);
    const [one, other] = rows;
    if (!one || !other) return;
    const key = [one, other, ...span];
    if (!this.#pairs || this.#pairs.key.some((part, i) => part !== key[i])) {
      this.#pairs = { key, pairs: toPairs(one, other, span) };
    }
    const isEqual = over[0].unit !== "" && over[0].unit === over[1].unit;
    const projection = new Projection(this.#pairs.pairs, size.width, size.height, noticeHeight, isEqual);
    drawPairs(context, this.#pairs.pairs, projection, over, theme);
    this.#projection = projection;
  }

  /** Draws the cursor on one line over the other. */
  #drawMoment(context: Context, over: [Axis, Axis], values: Values[], text: string): void {
    const { theme } = this.#card;
    const [x, y] = over.map(({ index }) => values[index]?.reading?.value ?? NaN) as [number, number];
    if (!this.#projection || Number.isNaN(x) || Number.isNaN(y)) return;
    const place = this.#projection.place(x, y);
    drawRing(context, place, theme);
    const font = `600 ${textFont(theme)}`;
    const isRight = place.x > this.#card.size.width / 2;
    const align = isRight ? "right" : "left";
    write(context, text, place.x + (isRight ? -10 : 10), place.y - 12, theme.ink, font, align, theme.background);
  }

  /** Updates the states and the conditions of a moment, below the lines of the legend. */
  #updateMore(time: number, span: Span, isPicked: boolean): void {
    const marks = this.#model.get("marks");
    const more: More[] = statesAt(this.#model.get("states"), isPicked ? time : NaN).map(([start, , path]) => {
      return { kind: "state", name: nameOf(path), text: `for ${toFixed(time - start, 2)} s`, isOn: true };
    });
    const names = [...new Set(marks.map(([, , text]) => text.split(":")[0] ?? ""))];
    for (const name of names.slice(0, MOST_MARKS)) {
      const own = marks.filter(([, , text]) => (text.split(":")[0] ?? "") === name);
      const isOn = isPicked && own.some(([start, end]) => time >= start && time <= end);
      const [count, seconds] = holding(own, span);
      const often = count === 1 ? "once" : `${count} times`;
      more.push({ kind: "mark", name: name || "marked", text: `${often}, ${toFixed(seconds, 2)} s`, isOn });
    }
    this.#legend.updateMore(more);
  }

  #close(): void {
    for (const chart of this.#charts) chart.close();
    this.#charts = [];
  }
}

/** Seconds of a span. */
function lengthOf([start, end]: Span): number {
  return end - start;
}
