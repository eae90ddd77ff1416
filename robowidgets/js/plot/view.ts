import type { Point } from "../shared/box.ts";
import { Canvas, circle, fill, line, stroke, write } from "../shared/canvas.ts";
import { Card } from "../shared/card.ts";
import { make, makeButton, makeIcon, PAUSE, PLAY, setLabel, setText } from "../shared/dom.ts";
import { isPlain, on, onAbort } from "../shared/events.ts";
import { toMany } from "../shared/format.ts";
import { describeMark, markBeside } from "../shared/marks.ts";
import { lacksKernel, type Model, NO_KERNEL, onChange, setTraits } from "../shared/model.ts";
import { offerPng } from "../shared/png.ts";
import { perAnimationFrame } from "../shared/schedule.ts";
import { textFont } from "../shared/theme.ts";
import { type Span, type TimeAxis, toTime, toX } from "../shared/time_axis.ts";
import { watchGestures } from "../shared/time_gestures.ts";
import { moved, toMoment, zoomed } from "../shared/time_span.ts";
import { Chart, SCALE, type Shown, TIMES } from "./chart.ts";
import type { PlotData } from "./data.ts";
import { type Group, toGroups } from "./groups.ts";
import { Legend, toValue, type Values } from "./legend.ts";
import { measure, readingAt, timeBeside } from "./rows.ts";
import { follows, type Looking, seen, wholeOf } from "./span.ts";
import type { PlotTraits } from "./traits.ts";

/** Width of a card from which the legend stands beside the graphs. */
const WIDE = 640;
const [LEAST_GRAPH, ONE_GRAPH, GRAPH] = [110, 230, 160];
const RIGHT = 14;
/** Seconds that are looked at, at least. */
const SHORTEST = 1e-4;
const LATE = "finer detail when the kernel is free";
const HINT = "least, mean and most are of this";
const NEVER = `no finer detail: ${NO_KERNEL}`;

/** One view of a plot: it wires the card, the graphs, the legend and the gestures together. */
export class PlotView {
  readonly #model: Model<PlotTraits>;
  readonly #data: PlotData;
  readonly #card: Card;
  readonly #graphs = make("div", "rw-plot-graphs");
  readonly #top: Canvas;
  readonly #legend = new Legend();
  readonly #empty = make("div", "rw-empty");
  readonly #span = make("span", "");
  readonly #fact = make("span", "");
  readonly #freeze: HTMLButtonElement;
  readonly #follow: HTMLButtonElement;
  readonly #all: HTMLButtonElement;
  readonly #redrawTop: () => void;
  #charts: Chart[] = [];
  #built = "";
  #pointer: Point | null = null;
  #draft: Span | null = null;

  constructor(model: Model<PlotTraits>, element: HTMLElement, data: PlotData, signal: AbortSignal) {
    this.#model = model;
    this.#data = data;
    this.#redrawTop = perAnimationFrame(() => this.#drawTop(), signal);
    this.#card = new Card(element, "plot", model, () => this.#draw(), signal);
    const { picture, controls, footer, root } = this.#card;
    // Screen readers leave the arrow keys to it.
    picture.role = "application";
    picture.append(this.#graphs);
    this.#top = new Canvas(picture);
    picture.append(this.#empty);
    picture.after(this.#legend.root);
    footer.append(this.#span, this.#fact);
    const closer = makeButton("rw-zoom", "Zoom in (+)", () => this.onZoom(0.5, null), signal, "+");
    const farther = makeButton("rw-zoom", "Zoom out (\u2212)", () => this.onZoom(2, null), signal, "\u2212");
    this.#all = makeButton("", "Show all of it (0, double click)", () => this.onReset(), signal, "All");
    const toNewest = () => setTraits(model, { view: null, window: model.get("window") ?? 30 });
    this.#follow = makeButton("", "Follow the newest values", toNewest, signal, "Newest");
    this.#freeze = makeButton("rw-plot-freeze", "", () => this.#toggle(), signal);
    controls.append(this.#follow, farther, closer, this.#all, this.#freeze);
    offerPng(this.#card, model, signal);
    onChange(
      model,
      ["_frame", "_detail", "_about", "units", "view", "window", "marks", "paused", "_frozen_at"],
      this.#card.redraw,
      signal,
    );
    onChange(model, ["time"], this.#redrawTop, signal);
    watchGestures(picture, this, signal);
    on(root, "keydown", (event) => this.#onKey(event), signal);
    onAbort(signal, () => this.#close());
  }

  onHover(point: Point | null): void {
    this.#pointer = point;
    this.#redrawTop();
  }

  onPress(): void {}

  onPick(point: Point): void {
    if (this.#axis) setTraits(this.#model, { time: toTime(this.#axis, point.x) });
  }

  onSelect(from: Point, to: Point, _rays: boolean, done: boolean): void {
    const axis = this.#axis;
    if (!axis) return;
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
    this.#look(zoomed(axis.span, factor, point ? toTime(axis, point.x) : middle, whole, SHORTEST));
  }

  onReset(): void {
    setTraits(this.#model, { view: null, window: null });
  }

  onClear(): void {
    setTraits(this.#model, { time: null });
  }

  /** To the next value of any line, or to the one before. */
  onStep(by: number): void {
    const looking = this.#looking;
    if (!looking) return;
    const [first, last] = wholeOf(looking);
    if (!Number.isFinite(by)) {
      this.#goTo(by < 0 ? first : last);
      return;
    }
    const from = this.#model.get("time") ?? seen(looking)[by > 0 ? 0 : 1];
    const times = this.#data.lines.flatMap((rows) => timeBeside(rows, from, by) ?? []).filter((time) => time <= last);
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
    const live = model.get("_about").live ?? false;
    return whole && { whole, view: model.get("view"), live, window: model.get("window"), frozenAt };
  }

  /** Where the times stand. */
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
    const { names = [] } = this.#model.get("_about");
    const units = this.#model.get("units");
    const values = this.#data.lines.map((rows, i) => {
      const reading = readingAt(rows, time);
      return `${names[i]} ${reading ? toValue(reading.value) : "no value"} ${units[names[i] ?? ""] ?? ""}`.trim();
    });
    const mark = this.#model.get("marks").length ? describeMark(this.#model.get("marks"), time).label : "";
    this.#card.say([`${time.toFixed(3)} s`, ...values, mark]);
  }

  #toggle(): void {
    const paused = !this.#model.get("paused");
    const frozenAt = paused ? (this.#data.whole?.[1] ?? null) : null;
    setTraits(this.#model, { paused, _frozen_at: frozenAt });
  }

  #onKey(event: KeyboardEvent): void {
    if (!isPlain(event) || event.key !== " " || event.target instanceof HTMLButtonElement) return;
    event.preventDefault();
    this.#toggle();
  }

  #draw(): void {
    const { names = [], error = "", live = false } = this.#model.get("_about");
    const groups = toGroups(names, this.#model.get("units"));
    const { lines } = this.#data;
    this.#card.updateFrame(error ? [error] : [], "error");
    const count = lines.reduce((sum, { total }) => sum + total, 0);
    this.#card.updateFacts(names.length ? [toMany(names.length, "line"), toMany(count, "value")] : []);
    this.#updateButtons(live);
    const looking = this.#looking;
    setText(this.#empty, lacksKernel(this.#model) ? NO_KERNEL : "waiting for values");
    this.#empty.hidden = looking !== null;
    this.#card.root.classList.toggle("rw-plot-wide", this.#card.width >= WIDE);
    // Until the lines of these names are there, as right after another one came.
    const isWhole = looking !== null && lines.length === names.length;
    if (isWhole || !names.length) this.#drawGraphs(isWhole ? groups : [], looking);
    this.#drawTop();
  }

  #updateButtons(live: boolean): void {
    const paused = this.#model.get("paused");
    const view = this.#model.get("view");
    this.#freeze.hidden = !live;
    this.#freeze.ariaPressed = String(paused);
    setLabel(this.#freeze, paused ? "Show the newest again (space)" : "Freeze the picture (space)");
    if (this.#freeze.dataset.state !== String(paused)) {
      this.#freeze.dataset.state = String(paused);
      this.#freeze.replaceChildren(makeIcon(paused ? PLAY : PAUSE), make("span", "", paused ? "Frozen" : "Freeze"));
    }
    this.#follow.hidden = !live || (view === null && this.#model.get("window") !== null);
    this.#all.disabled = view === null && (!live || this.#model.get("window") === null);
    this.#card.root.classList.toggle("rw-frozen", paused);
  }

  #drawGraphs(groups: Group[], looking: Looking | null): void {
    const { size, theme, picture, noticeHeight } = this.#card;
    const count = Math.max(1, groups.length);
    const graph = count === 1 ? ONE_GRAPH : GRAPH;
    picture.style.setProperty("--rw-plot-height", `${count * graph + TIMES + noticeHeight}px`);
    this.#graphs.style.top = `${noticeHeight}px`;
    const height = Math.max(LEAST_GRAPH * count, size.height - noticeHeight);
    const key = JSON.stringify([groups, theme.font]);
    const toShown = ({ entries }: Group, i: number): Shown => ({
      rows: entries.flatMap(({ index }) => this.#data.lines[index] ?? []),
      span: looking ? seen(looking) : [0, 1],
      end: looking ? wholeOf(looking)[1] : 1,
      marks: this.#model.get("marks"),
      theme,
      width: size.width,
      height: Math.floor((height - TIMES) / count) + (i === count - 1 ? TIMES : 0),
      right: RIGHT,
    });
    if (key !== this.#built) {
      this.#built = key;
      this.#close();
      this.#legend.build(groups);
      this.#charts = groups.map(
        (group, i) => new Chart(this.#graphs, group, i === 0, i === groups.length - 1, toShown(group, i)),
      );
    }
    this.#legend.root.hidden = !groups.length;
    for (const [i, chart] of this.#charts.entries()) chart.draw(toShown(chart.group, i));
    if (looking && groups.length) this.#askFor(looking);
  }

  /** Asks Python for what the page lacks of the span on show. */
  #askFor(looking: Looking): void {
    const span = seen(looking);
    const columns = Math.max(1, Math.round((this.#card.size.width - SCALE - RIGHT) * devicePixelRatio));
    const isFine = !this.#data.lacks(span, columns);
    const wanted = follows(looking) ? [] : [...span, columns];
    const isAlone = lacksKernel(this.#model);
    const isHint = isFine || follows(looking);
    setText(this.#fact, isHint ? HINT : isAlone ? NEVER : LATE);
    this.#fact.classList.toggle("rw-plot-hint", isHint);
    const isAsked = this.#model.get("_wanted").join() === wanted.join();
    if (!isAlone && !isAsked && (!wanted.length || !isFine)) setTraits(this.#model, { _wanted: wanted });
  }

  /** Draws what moves with the pointer, and the values there. */
  #drawTop(): void {
    const { size, theme, noticeHeight } = this.#card;
    const context = this.#top.begin(size);
    const { axis, looking } = { axis: this.#axis, looking: this.#looking };
    if (!axis || !looking || !this.#charts.length) return;
    const [first, last] = wholeOf(looking);
    const pointed = this.#pointer && this.#pointer.x >= axis.left ? toTime(axis, this.#pointer.x) : null;
    const picked = this.#model.get("time");
    const time = pointed ?? picked ?? Math.min(last, axis.span[1]);
    const isShown = (pointed ?? picked) !== null && time >= axis.span[0] && time <= axis.span[1];
    const { lines } = this.#data;
    const values: Values[] = lines.map((rows) => ({
      reading: readingAt(rows, time),
      measures: measure(rows, [Math.max(first, axis.span[0]), Math.min(last, axis.span[1])]),
    }));
    this.#legend.update(values);
    const font = textFont(theme);
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
      const x = Math.min(size.width - half, Math.max(axis.left + half, toX(axis, time)));
      write(context, text, x, noticeHeight + 10, theme.ink, `600 ${font}`, "center", theme.background);
    }
    const [from, to] = axis.span.map((one) => toMoment(one, last));
    setText(this.#span, `seen ${from} to ${to}`);
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
