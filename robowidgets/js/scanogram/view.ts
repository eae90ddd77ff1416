import type { Point, Size } from "../shared/box.ts";
import { Card } from "../shared/card.ts";
import { make, makeButton, set, setHidden, setText } from "../shared/dom.ts";
import { lacksKernel, type Model, NO_KERNEL, onChange } from "../shared/model.ts";
import { offerPng } from "../shared/png.ts";
import { Popup } from "../shared/popup.ts";
import { perAnimationFrame } from "../shared/schedule.ts";
import { type Span, toTime, toX } from "../shared/time_axis.ts";
import { watchGestures } from "../shared/time_gestures.ts";
import { moved, toSeconds, zoomed } from "../shared/time_span.ts";
import type { Pointing } from "../shared/traits.ts";
import { Legend } from "./legend.ts";
import { pointAt } from "./point.ts";
import { selectedRays } from "./rows.ts";
import { type Pointed, Scene } from "./scene.ts";
import type { State } from "./state.ts";
import { describeSelection, toFacts } from "./text.ts";
import type { ScanogramTraits } from "./traits.ts";

const MEDIAN = "Show the median, not the nearest, of the readings that share a pixel";
const LATE = "finer detail when the kernel is free";
const LATE_MEDIAN = "medians when the kernel is free";
/** Pixels from a pop-up to the thing that it names, and to the edge of the picture. */
const [GAP, MARGIN] = [14, 4];
const NEVER = `no finer detail: ${NO_KERNEL}`;

/** One view of a scanogram: it wires the card, the scene, the legend, the pop-up and the gestures together. */
export class ScanogramView {
  readonly #model: Model<ScanogramTraits & Pointing>;
  readonly #state: State;
  readonly #card: Card;
  readonly #scene: Scene;
  readonly #legend: Legend;
  readonly #popup: Popup;
  readonly #empty = make("div", "rw-empty");
  readonly #chip = make("div", "rw-scanogram-chip");
  readonly #all: HTMLButtonElement;
  readonly #median: HTMLButtonElement;
  readonly #redrawTop: () => void;
  #pointer: Point | null = null;
  /** A selection that is being dragged. */
  #draft: number[] | null = null;

  constructor(model: Model<ScanogramTraits & Pointing>, element: HTMLElement, state: State, signal: AbortSignal) {
    this.#model = model;
    this.#state = state;
    this.#redrawTop = perAnimationFrame(() => this.#drawTop(), signal);
    this.#card = new Card(element, "scanogram", model, () => this.#draw(), signal);
    const { picture } = this.#card;
    this.#scene = new Scene(picture);
    this.#legend = new Legend(this.#card, () => this.onClear(), signal);
    this.#popup = new Popup(picture, signal);
    picture.append(this.#empty, this.#chip);
    const closer = makeButton("rw-zoom", "Zoom in (+)", () => this.onZoom(0.5, null), signal, "+");
    const farther = makeButton("rw-zoom", "Zoom out (\u2212)", () => this.onZoom(2, null), signal, "\u2212");
    this.#all = makeButton("", "Show all of it (0, double click)", () => this.onReset(), signal, "All");
    this.#median = makeButton("", MEDIAN, () => this.#onMedian(), signal, "Median");
    this.#card.controls.append(this.#median, farther, closer, this.#all);
    onChange(model, ["time", "selection", "_ray"], this.#redrawTop, signal);
    state.listen(this.#card.redraw, signal);
    watchGestures(picture, this, signal);
    offerPng(this.#card, model, signal);
  }

  onHover(point: Point | null): void {
    this.#pointer = point;
    this.#state.point(point && this.#pointedAt(point));
    this.#redrawTop();
  }

  onPress(point: Point): void {
    this.#state.point(this.#pointedAt(point));
  }

  onPick(point: Point): void {
    if (this.#state.blocks) this.#state.set({ time: this.#timeAt(point) });
  }

  onSelect(from: Point, to: Point, rays: boolean, done: boolean): void {
    if (!this.#state.whole) return;
    const times = [from, to].map(({ x }) => Math.round(toTime(this.#scene.axis, x) * 1e4) / 1e4);
    const [start, end] = [Math.min(...times), Math.max(...times)];
    const selected = selectedRays(this.#scene.rows, this.#scene.toRow(from.y), this.#scene.toRow(to.y));
    this.#draft = rays && !this.#scene.rows.byAngle ? [start, end, ...selected] : [start, end];
    if (done) {
      const selection = this.#draft;
      this.#draft = null;
      if (end > start) this.#state.set({ selection });
    }
    this.#redrawTop();
  }

  onCancel(): void {
    this.#draft = null;
    this.#redrawTop();
  }

  onPan(pixels: number): void {
    const { whole, view } = this.#state;
    if (whole) this.#look(moved(view, (pixels / this.#scene.axis.width) * (view[1] - view[0]), whole.span));
  }

  canZoom(factor: number): boolean {
    const { whole, view } = this.#state;
    const length = view[1] - view[0];
    return whole !== null && (factor < 1 ? length > whole.pause : length < lengthOf(whole.span));
  }

  onZoom(factor: number, point: Point | null): void {
    const { whole, view, time } = this.#state;
    if (!whole) return;
    const isSeen = time >= view[0] && time <= view[1];
    const around = point ? toTime(this.#scene.axis, point.x) : isSeen ? time : (view[0] + view[1]) / 2;
    this.#look(zoomed(view, factor, around, whole.span, whole.pause));
  }

  #onMedian(): void {
    this.#state.set({ pixel: this.#state.pixel === "median" ? "nearest" : "median" });
  }

  onReset(): void {
    this.#state.set({ view: null });
  }

  onClear(): void {
    this.#state.set({ selection: null });
  }

  onStep(by: number): void {
    const { whole, blocks, time } = this.#state;
    if (!whole || !blocks) return;
    this.#goTo(Number.isFinite(by) ? blocks.step(time, by) : by < 0 ? whole.span[0] : whole.span[1]);
  }

  onMark(direction: -1 | 1): void {
    this.#goTo(this.#state.markBeside(direction));
  }

  #pointedAt(point: Point): Pointing["_pointed"] {
    const { layout, rows } = this.#scene;
    const { left, width, scans, bottom } = layout;
    if (!this.#state.blocks || point.x < left || point.x >= left + width || point.y > bottom) return null;
    const isRay = point.y >= scans.top && point.y < scans.top + scans.height && !rows.byAngle;
    return { time: this.#timeAt(point), ray: isRay ? (rows.rayOf[this.#scene.toRow(point.y)] ?? null) : null };
  }

  /** The time of a click; the start of a scan if the page has single scans. */
  #timeAt({ x }: Point): number {
    const time = toTime(this.#scene.axis, x);
    const place = this.#state.blocks?.at(time, 0);
    return place?.scans === 1 ? place.time : Math.round(time * 1e4) / 1e4;
  }

  /** Moves the cursor, and the view if the cursor would leave it. */
  #goTo(time = this.#state.time): void {
    const { whole, view } = this.#state;
    this.#state.set({ time });
    if (whole && (time < view[0] || time > view[1])) {
      this.#look(moved(view, time - (view[0] + view[1]) / 2, whole.span));
    }
  }

  #look(span: Span): void {
    const whole = lengthOf(this.#state.whole?.span);
    this.#state.set({ view: lengthOf(span) >= whole * (1 - 1e-9) ? null : span });
  }

  #draw(): void {
    const { whole, view } = this.#state;
    const { error, notes = [] } = this.#model.get("_about");
    this.#card.updateFrame(error ? [error, ...notes] : notes, error ? "error" : "note");
    this.#card.updateFacts(whole ? toFacts(whole) : []);
    setHidden(this.#empty, whole !== null);
    const isAlone = lacksKernel(this.#model);
    setText(this.#empty, isAlone ? NO_KERNEL : "waiting for scans");
    const late = this.#state.lacksPixels ? LATE_MEDIAN : LATE;
    setText(this.#chip, isAlone ? NEVER : late);
    setHidden(this.#chip, !this.#state.waits && !this.#state.lacksPixels);
    set(this.#median, "ariaPressed", String(this.#state.pixel === "median"));
    set(this.#all, "disabled", lengthOf(view) >= lengthOf(whole?.span));
    const { theme, size } = this.#card;
    this.#scene.measure(size, whole, this.#state.states, view, this.#card.noticeHeight);
    this.#scene.drawBase(this.#state, theme);
    this.#legend.place(this.#model.get("header"), this.#model.get("footer"), size.width);
    this.#legend.drawKey(whole, this.#scene.colors, theme);
    this.#state.look(view, this.#scene.columns);
    this.#drawTop();
  }

  #drawTop(): void {
    const { time, selection, blocks, whole } = this.#state;
    const shown = this.#draft ?? selection;
    const { ray } = this.#state;
    const pointed = this.#drawPopup() ?? (ray === null ? null : { time, row: this.#scene.rows.rowOf[ray] ?? null });
    this.#scene.drawTop(time, shown, pointed, this.#card.theme);
    const scans = blocks?.count((shown ?? [0, 0]) as Span) ?? { scans: 0, exact: true };
    this.#legend.drawState(
      toSeconds(time),
      shown ? describeSelection(shown, scans, whole?.driveScans !== undefined) : "",
    );
  }

  /** Draws the pop-up of the thing under the pointer; returns the moment there, and the row. */
  #drawPopup(): Pointed | null {
    const point = this.#pointer;
    const time = point && this.#pointedAt(point)?.time;
    const found = point && pointAt(point, this.#scene, this.#state);
    if (!found) this.#popup.hide();
    else {
      const at = { x: toX(this.#scene.axis, found.time), y: found.y };
      this.#popup.show(found.words, (size) => placeBeside(size, this.#card.size, at));
    }
    return typeof time === "number" ? { time, row: found?.row ?? null } : null;
  }
}

/** Place of a pop-up: right of the thing it names if there is room, else left of it; always inside the picture. */
function placeBeside(popup: Size, inside: Size, at: Point): Point {
  const right = at.x + GAP;
  const fits = right + popup.width <= inside.width - MARGIN;
  const x = fits ? right : Math.max(MARGIN, at.x - GAP - popup.width);
  const y = at.y - popup.height - GAP / 2;
  return { x, y: Math.min(inside.height - popup.height - MARGIN, Math.max(MARGIN, y)) };
}

/** Seconds of a span. */
function lengthOf([start, end]: Span = [0, 0]): number {
  return end - start;
}
