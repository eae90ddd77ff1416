import { Canvas } from "../shared/canvas.ts";
import { CopyCode } from "../shared/copy.ts";
import { make, makeButton, pointIn, set, setHidden, setText } from "../shared/dom.ts";
import { isOver, isPlain, on, onAbort } from "../shared/events.ts";
import { toMany, toShortMetres } from "../shared/format.ts";
import type { Ring, SonarAbout } from "../shared/frames/ring.ts";
import { FARTHEST_VIEW } from "../shared/frames/scan.ts";
import { lacksKernel, type Model, onChange, setTraits } from "../shared/model.ts";
import { Occupancy } from "../shared/occupancy.ts";
import { Popup, toSentence } from "../shared/popup.ts";
import { placePopup } from "../shared/popup_place.ts";
import { SampleCard } from "../shared/sample_card.ts";
import type { Stream } from "../shared/stream.ts";
import type { Theme } from "../shared/theme.ts";
import { stepRange, watchZoom, ZOOM_KEYS, type Zoom } from "../shared/zoom.ts";
import { type Cone, fitReadings, nextSilence, reachOf, resolveRange, toCones } from "./cones.ts";
import {
  distanceFont,
  drawCones,
  drawLabels,
  drawPointed,
  drawScale,
  endOf,
  linesOf,
  nameFont,
  pointsOf,
} from "./draw.ts";
import { toFloorPoint, toPixel } from "./floor.ts";
import { Footer } from "./footer.ts";
import { type Half, type Layout, type Level, LINE, layOut } from "./labels.ts";
import { pick } from "./pick.ts";
import { describeCone, toCode, toDistance } from "./text.ts";
import type { SonarTraits } from "./traits.ts";

const WALK: Record<string, number> = {
  ArrowRight: 1,
  ArrowUp: 1,
  ArrowLeft: -1,
  ArrowDown: -1,
  Home: -Infinity,
  End: Infinity,
};
/** Metres up to which a picture without limits zooms out. */
const SOMEWHERE = 100;

/** One view of a sonar widget: it wires the card, the cones, the labels, the pop-ups and the gestures. */
export class SonarView implements Zoom {
  readonly #model: Model<SonarTraits>;
  readonly #stream: Stream<Ring>;
  readonly #card: SampleCard;
  readonly #canvas: Canvas;
  readonly #footer: Footer;
  readonly #empty = make("div", "rw-empty");
  readonly #places = make("div", "rw-sonar-places");
  readonly #range = make("span", "rw-range");
  readonly #fit: HTMLButtonElement;
  readonly #copy: CopyCode;
  readonly #picked: Popup;
  readonly #hovered: Popup;
  readonly #tell = () => this.#footer.update(this.#cones, this.#model.get("near"), this.#viewRange);
  #cones: Cone[] = [];
  #layout: Layout | null = null;
  #layoutKey = "";
  /** Metres to the edge of the view. */
  #viewRange = 0;
  #hoveredName: string | null = null;
  #pickedName: string | null = null;
  #tick: ReturnType<typeof setTimeout> | undefined;

  constructor(model: Model<SonarTraits>, element: HTMLElement, stream: Stream<Ring>, signal: AbortSignal) {
    this.#model = model;
    this.#stream = stream;
    this.#card = new SampleCard(element, "sonar", model, stream, () => this.#draw(), signal);
    const { picture, footer, root } = this.#card;
    // Screen readers leave the arrow keys to it.
    picture.role = "application";
    this.#canvas = new Canvas(picture);
    picture.append(this.#places, this.#empty);
    const say = (words: string[]) => this.#card.say(words);
    this.#copy = new CopyCode(() => toCode(this.#pickedName ?? ""), say, signal);
    for (const part of [this.#copy.row, this.#copy.field]) part.classList.add("rw-over");
    this.#picked = new Popup(picture, signal, this.#copy.row, this.#copy.field);
    this.#hovered = new Popup(picture, signal);
    this.#footer = new Footer(footer);
    const closer = makeButton("rw-zoom", "Zoom in (+)", () => this.onZoom(-1), signal, "+");
    const farther = makeButton("rw-zoom", "Zoom out (\u2212)", () => this.onZoom(1), signal, "\u2212");
    this.#fit = makeButton("rw-fit", "Fit the view to readings (0)", () => this.#onFit(), signal, "Fit");
    this.#card.addControls(farther, this.#range, closer, this.#fit);
    onChange(model, ["poses", "near", "field_of_view", "view_range"], this.#card.redraw, signal);
    onAbort(signal, () => clearTimeout(this.#tick));
    on(picture, "pointermove", (event) => this.#onPointer(event), signal);
    on(picture, "pointerleave", () => this.#hover(null), signal);
    on(picture, "click", (event) => this.#onClick(event), signal);
    on(root, "keydown", (event) => this.#onKey(event), signal);
    watchZoom(picture, this, signal);
  }

  onZoom(direction: -1 | 1): void {
    const metres = this.#zoomed(direction);
    setTraits(this.#model, { view_range: metres === reachOf(this.#cones) ? null : metres });
  }

  canZoom(direction: -1 | 1): boolean {
    return this.#zoomed(direction) !== (this.#model.get("view_range") ?? this.#viewRange);
  }

  #zoomed(direction: -1 | 1): number {
    const most = reachOf(this.#cones) || Math.max(SOMEWHERE, this.#viewRange);
    // Two keys may be pressed before the next drawing.
    const now = this.#model.get("view_range") ?? this.#viewRange;
    return stepRange(now, direction, Math.min(most, FARTHEST_VIEW));
  }

  #onFit(): void {
    const fitted = fitReadings(this.#cones);
    const isFitted = this.#model.get("view_range") === fitted;
    if (fitted) setTraits(this.#model, { view_range: isFitted ? null : fitted });
  }

  /** Seconds since the newest frame arrived; 0 if time stands still. */
  get #elapsed(): number {
    const { paused, arrived } = this.#stream;
    const isStill = paused || (this.#stream.about as SonarAbout).still || !arrived || lacksKernel(this.#model);
    return isStill ? 0 : (performance.now() - arrived) / 1000;
  }

  #draw(): void {
    const [model, stream, card] = [this.#model, this.#stream, this.#card];
    const ring = stream.shown;
    const [poses, near] = [model.get("poses"), model.get("near")];
    this.#cones = ring
      ? toCones(ring, stream.about, { poses, near, fieldOfView: model.get("field_of_view"), elapsed: this.#elapsed })
      : [];
    const cones = this.#cones;
    const hasCome = cones.some((cone) => cone.hasCome);
    this.#viewRange = resolveRange(model.get("view_range"), cones, this.#viewRange);
    const context = this.#canvas.begin(card.size);
    const { theme } = card;
    const layout = this.#layOut(context, theme);
    drawCones(context, layout.view, cones, theme);
    drawScale(context, layout.view, cones, theme);
    const [picked, hovered] = [this.#named(this.#pickedName), this.#named(this.#hoveredName)];
    for (const cone of [picked, hovered]) if (cone) drawPointed(context, layout.view, cone, theme);
    drawLabels(context, layout, cones, theme);
    card.update([cones.length ? toMany(cones.length, "sensor") : ""], "range");
    setText(this.#empty, hasCome ? "" : card.waiting("range"));
    setHidden(this.#empty, hasCome);
    setText(this.#range, hasCome ? toShortMetres(this.#viewRange) : "");
    set(this.#fit, "ariaPressed", String(hasCome && model.get("view_range") === fitReadings(cones)));
    setText(this.#places, wordsOnPlaces(cones));
    this.#drawPopups(layout, picked, hovered);
    card.texts.ask(this.#tell);
    this.#wait();
  }

  /** Draws again when the next sensor becomes silent: the frames of the others may have stopped, too. */
  #wait(): void {
    clearTimeout(this.#tick);
    const left = this.#elapsed ? nextSilence(this.#cones) : Infinity;
    if (left < Infinity) this.#tick = setTimeout(this.#card.redraw, 1000 * left + 20);
  }

  /** Lays out circle and labels; again only if something in them has changed. */
  #layOut(context: CanvasRenderingContext2D, theme: Theme): Layout {
    const { size, noticeHeight } = this.#card;
    const cones = this.#cones;
    // The labels that are left out without enough room depend on the alarms.
    const drops = this.#layout !== null && this.#layout.labels.length < cones.length;
    const sensors = cones.map(({ name, mount, isNear, isSilent, hasCome }) => {
      return [name, mount, isSilent, hasCome, drops && isNear];
    });
    const key = JSON.stringify([sensors, size, noticeHeight, this.#viewRange, theme.font]);
    if (this.#layout && key === this.#layoutKey) return this.#layout;
    this.#layoutKey = key;
    const hint = wordsOnPlaces(cones) ? 16 : 0;
    const height = Math.max(40, size.height - noticeHeight - hint);
    const box = { x: 0, y: noticeHeight, width: size.width, height };
    const widthOf = (font: string, ...texts: string[]) => {
      context.font = font;
      return Math.max(...texts.map((text) => context.measureText(text).width));
    };
    const digits = this.#viewRange >= 10 ? "00.00" : "0.00";
    const halfOf = (cone: Cone, level: Level): Half => {
      // The widest usual text, so that labels stand still; rare texts may move them.
      const says = level < 2 ? [`${digits}!`] : [`\u25B2 ${digits} m`, "\u25B2 too close"];
      if (cone.isSilent || !cone.hasCome) says.push(toDistance(cone, this.#viewRange, level < 2));
      const lines = linesOf(cone, level);
      const width = Math.max(widthOf(distanceFont(theme), ...says), widthOf(nameFont(theme), "", ...lines));
      return { width: width / 2 + (level < 2 ? 1 : 4), height: (LINE * (lines.length + 1)) / 2 };
    };
    this.#layout = layOut(cones, box, this.#viewRange, halfOf);
    return this.#layout;
  }

  #named(name: string | null): Cone | undefined {
    return name === null ? undefined : this.#cones.find((cone) => cone.name === name);
  }

  #drawPopups({ view, labels }: Layout, picked: Cone | undefined, hovered: Cone | undefined): void {
    if (!picked && !hovered) {
      this.#picked.hide();
      this.#hovered.hide();
      return;
    }
    const { width, height } = this.#card.size;
    const box = { x: 0, y: this.#card.noticeHeight, width, height: height - this.#card.noticeHeight };
    const occupied = new Occupancy(width, height);
    for (const cone of this.#cones) for (const { x, y } of pointsOf(view, cone)) occupied.mark(x, y);
    const others: { x: number; y: number; width: number; height: number }[] = [];
    const show = (popup: Popup, cone: Cone | undefined) => {
      if (!cone) return popup.hide();
      const from = toPixel(view, cone.mount);
      const to = toPixel(view, toFloorPoint(cone.mount, endOf(view, cone), 0));
      const boxes = labels.map((label) => label.box);
      const words = describeCone(cone, this.#model.get("near"), this.#viewRange);
      others.push(popup.show(words, (size) => placePopup(size, box, from, to, occupied, others, boxes)));
    };
    show(this.#picked, picked);
    show(this.#hovered, hovered === picked ? undefined : hovered);
  }

  #onPointer(event: PointerEvent): void {
    if (event.pointerType === "touch") return;
    this.#hover(isOver(event) ? null : this.#nameAt(event));
  }

  #hover(name: string | null): void {
    if (this.#hoveredName === name) return;
    this.#hoveredName = name;
    this.#card.redraw();
  }

  #onClick(event: MouseEvent): void {
    if (isOver(event)) return;
    const name = this.#nameAt(event);
    this.#pick(name === this.#pickedName ? null : name);
  }

  #nameAt(event: MouseEvent): string | null {
    const layout = this.#layout;
    const index = layout && pick(layout.view, this.#cones, layout.labels, pointIn(this.#card.picture, event));
    return index === null ? null : (this.#cones[index]?.name ?? null);
  }

  #pick(name: string | null): void {
    this.#pickedName = name;
    this.#copy.reset();
    this.#card.redraw();
  }

  #onKey(event: KeyboardEvent): void {
    if (!isPlain(event)) return;
    const [by, direction] = [WALK[event.key], ZOOM_KEYS[event.key]];
    if (event.key === "Escape" && this.#pickedName !== null) this.#pick(null);
    else if (event.key === "c" && this.#pickedName !== null) void this.#copy.copy();
    else if (direction) this.onZoom(direction);
    else if (event.key === "0") this.#onFit();
    else if (by !== undefined && this.#cones.length) this.#walk(by);
    else return;
    event.preventDefault();
  }

  #walk(by: number): void {
    const at = this.#named(this.#pickedName)?.index;
    const last = this.#cones.length - 1;
    const next = at === undefined ? (by === Infinity ? last : 0) : Math.min(last, Math.max(0, at + by));
    const cone = this.#cones[next];
    this.#pick(cone?.name ?? null);
    if (cone) this.#card.say(toSentence(describeCone(cone, this.#model.get("near"), this.#viewRange)));
  }
}

/** The origin of the places that the user did not give. */
function wordsOnPlaces(cones: Cone[]): string {
  const unknown = cones.filter(({ mount }) => !mount.isKnown);
  if (!unknown.length) return "";
  const which = unknown.length === cones.length ? "places not known" : `place of ${unknown[0]?.name} not known`;
  return `${which}: spread evenly by name`;
}
