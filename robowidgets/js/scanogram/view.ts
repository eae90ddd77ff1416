import { Popup } from "../laser/popup.ts";
import type { Point } from "../laser/projection.ts";
import { type Surface, watchSize } from "../shared/canvas.ts";
import { Card } from "../shared/card.ts";
import { make, makeButton, setText } from "../shared/dom.ts";
import { lacksKernel, type Model, NO_KERNEL, onChange } from "../shared/model.ts";
import { offerPng } from "../shared/png.ts";
import { perAnimationFrame } from "../shared/schedule.ts";
import { moved, toSeconds, toTime, toX, zoomed } from "./axis.ts";
import { watchGestures } from "./gestures.ts";
import { Legend } from "./legend.ts";
import { pointAt } from "./point.ts";
import { placeBeside } from "./popup_place.ts";
import { selectedRays } from "./rows.ts";
import { type Pointed, Scene } from "./scene.ts";
import type { State } from "./state.ts";
import { describeSelection, toFacts } from "./text.ts";
import type { ScanogramTraits, Span } from "./traits.ts";

const LATE = "finer detail when the kernel is free";
const NEVER = `no finer detail: ${NO_KERNEL}`;

/** One view of a scanogram: it wires the card, the scene, the legend, the pop-up and the gestures together. */
export class ScanogramView {
  readonly #model: Model<ScanogramTraits>;
  readonly #state: State;
  readonly #card: Card;
  readonly #scene: Scene;
  readonly #legend: Legend;
  readonly #popup: Popup;
  readonly #empty = make("div", "rw-empty");
  readonly #chip = make("div", "rw-scanogram-chip");
  readonly #all: HTMLButtonElement;
  readonly #redraw: () => void;
  readonly #redrawTop: () => void;
  #size: Surface = { width: 0, height: 0, ratio: 1 };
  #pointer: Point | null = null;
  /** A selection that is being dragged. */
  #draft: number[] | null = null;

  constructor(model: Model<ScanogramTraits>, element: HTMLElement, state: State, signal: AbortSignal) {
    this.#model = model;
    this.#state = state;
    this.#redraw = perAnimationFrame(() => this.#draw(), signal);
    this.#redrawTop = perAnimationFrame(() => this.#drawTop(), signal);
    this.#card = new Card(element, "scanogram", model, this.#redraw, signal);
    const { picture, footer } = this.#card;
    this.#scene = new Scene(picture);
    this.#legend = new Legend(footer, () => this.onClear(), signal);
    this.#popup = new Popup(picture);
    picture.append(this.#empty, this.#chip);
    const closer = makeButton("rw-zoom", "Zoom in (+)", () => this.onZoom(0.5, null), signal, "+");
    const farther = makeButton("rw-zoom", "Zoom out (\u2212)", () => this.onZoom(2, null), signal, "\u2212");
    this.#all = makeButton("", "Show all of it (0, double click)", () => this.onReset(), signal, "All");
    this.#card.controls.append(farther, closer, this.#all);
    onChange(model, ["time", "selection"], this.#redrawTop, signal);
    state.listen(this.#redraw, signal);
    watchGestures(picture, this, signal);
    const onSize = (size: Surface) => {
      this.#size = size;
      this.#draw();
    };
    offerPng(this.#card, model, watchSize(picture, onSize, signal), signal);
  }

  onHover(point: Point | null): void {
    this.#pointer = point;
    this.#state.point(point && this.#timeAt(point));
    this.#redrawTop();
  }

  onPress(point: Point): void {
    this.#state.point(this.#timeAt(point));
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

  onPan(pixels: number): void {
    const { whole, view } = this.#state;
    if (whole) this.#look(moved(view, (pixels / this.#scene.axis.width) * (view[1] - view[0]), whole.duration));
  }

  canZoom(factor: number): boolean {
    const { whole, view } = this.#state;
    const length = view[1] - view[0];
    return whole !== null && (factor < 1 ? length > whole.pause : length < whole.duration);
  }

  onZoom(factor: number, point: Point | null): void {
    const { whole, view, time } = this.#state;
    if (!whole) return;
    const isSeen = time >= view[0] && time <= view[1];
    const around = point ? toTime(this.#scene.axis, point.x) : isSeen ? time : (view[0] + view[1]) / 2;
    this.#look(zoomed(view, factor, around, whole.duration, whole.pause));
  }

  onReset(): void {
    this.#state.set({ view: null });
  }

  onClear(): void {
    this.#draft = null;
    this.#state.set({ selection: null });
  }

  onStep(by: number): void {
    const { whole, blocks, time } = this.#state;
    if (!whole || !blocks) return;
    this.#goTo(Number.isFinite(by) ? blocks.step(time, by) : by < 0 ? 0 : whole.duration);
  }

  onMark(direction: -1 | 1): void {
    this.#goTo(this.#state.markBeside(direction));
  }

  /** The time of a click; the start of a scan where the page has single scans. */
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
      this.#look(moved(view, time - (view[0] + view[1]) / 2, whole.duration));
    }
  }

  #look(span: Span): void {
    const duration = this.#state.whole?.duration ?? 0;
    this.#state.set({ view: span[1] - span[0] >= duration * (1 - 1e-9) ? null : span });
  }

  #draw(): void {
    const { whole, view, colors } = this.#state;
    if (!this.#size.width) return;
    const { error, notes = [] } = this.#model.get("_about");
    this.#card.updateFrame(error ? [error, ...notes] : notes, error ? "error" : "note");
    this.#card.updateFacts(whole ? toFacts(whole) : []);
    this.#empty.hidden = whole !== null;
    const isAlone = lacksKernel(this.#model);
    setText(this.#empty, isAlone ? NO_KERNEL : "waiting for scans");
    setText(this.#chip, isAlone ? NEVER : LATE);
    this.#chip.hidden = !this.#state.waits;
    this.#all.disabled = view[1] - view[0] >= (whole?.duration ?? 0);
    const { theme } = this.#card;
    this.#scene.measure(this.#size, whole, view, this.#card.noticeHeight);
    this.#scene.drawBase(this.#state, theme);
    this.#legend.drawKey(whole, colors, theme);
    this.#state.look(view, this.#scene.columns);
    this.#drawTop();
  }

  #drawTop(): void {
    const { time, selection, blocks } = this.#state;
    const shown = this.#draft ?? selection;
    const pointed = this.#drawPopup();
    this.#scene.drawTop(time, shown, pointed, this.#card.theme);
    const scans = blocks?.count((shown ?? [0, 0]) as Span) ?? { scans: 0, exact: true };
    this.#legend.drawState(toSeconds(time), shown ? describeSelection(shown, scans) : "");
  }

  /** Names what is pointed at. */
  #drawPopup(): Pointed | null {
    const found = this.#pointer && pointAt(this.#pointer, this.#scene, this.#state);
    if (!found) {
      this.#popup.hide();
      return null;
    }
    const { words, time, row, y } = found;
    const at = { x: toX(this.#scene.axis, time), y };
    this.#popup.show(words, (size) => placeBeside(size, this.#size, at));
    return { time, row };
  }
}
