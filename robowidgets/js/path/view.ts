import { Canvas } from "../shared/canvas.ts";
import { make, pointIn, setHidden, setText } from "../shared/dom.ts";
import { isPlain, on } from "../shared/events.ts";
import { fit, type Place, type Projection, toFloor, toPixel } from "../shared/floor.ts";
import { toFixed, toMetres } from "../shared/format.ts";
import { type Model, onChange } from "../shared/model.ts";
import { Occupancy } from "../shared/occupancy.ts";
import { Popup, toSentence } from "../shared/popup.ts";
import { placePopup } from "../shared/popup_place.ts";
import { SampleCard } from "../shared/sample_card.ts";
import type { Stream } from "../shared/stream.ts";
import type { Picking } from "../shared/traits.ts";
import { drawGrid, drawPath } from "./draw.ts";
import { boundsOf, isKnown, nearestOn, type Point, type PoseFrame, splitAt, toPoints } from "./path.ts";
import { describePoint, toHeading, toPlace } from "./text.ts";
import type { PathTraits } from "./traits.ts";

/** Pixels from the path within which a place of it is named. */
const REACH = 40;
const WALK: Record<string, number> = {
  ArrowRight: 1,
  ArrowUp: 1,
  ArrowLeft: -1,
  ArrowDown: -1,
  PageUp: 10,
  PageDown: -10,
  Home: -Infinity,
  End: Infinity,
};

/** One view of a path widget: it wires the card, the drawing, the pop-up and the gestures. */
export class PathView {
  readonly #model: Model<PathTraits & Picking>;
  readonly #stream: Stream<PoseFrame>;
  readonly #card: SampleCard;
  readonly #canvas: Canvas;
  readonly #popup: Popup;
  readonly #empty = make("div", "rw-empty");
  readonly #pose = make("span", "rw-strong");
  readonly #way = make("span", "");
  #projection: Projection | null = null;
  #points: Point[] = [];
  /** Those on show, up to the present pose and after it. */
  #shown: Point[] = [];
  #pointer: Place | null = null;
  #picked: Point | null = null;

  constructor(
    model: Model<PathTraits & Picking>,
    element: HTMLElement,
    stream: Stream<PoseFrame>,
    signal: AbortSignal,
  ) {
    this.#model = model;
    this.#stream = stream;
    this.#card = new SampleCard(element, "path", model, stream, () => this.#draw(), signal);
    const { picture, footer, root } = this.#card;
    // Screen readers leave the arrow keys to it.
    picture.role = "application";
    this.#canvas = new Canvas(picture);
    this.#popup = new Popup(picture, signal);
    picture.append(this.#empty);
    footer.append(this.#pose, this.#way);
    onChange(model, ["_path"], () => this.#onPath(), signal);
    on(picture, "pointermove", (event) => this.#onPointer(event), signal);
    on(picture, "pointerleave", () => this.#onPointer(null), signal);
    on(picture, "click", (event) => this.#onClick(event), signal);
    on(root, "keydown", (event) => this.#onKey(event), signal);
    this.#onPath();
  }

  #onPath(): void {
    this.#points = toPoints(this.#model.get("_path"));
    this.#card.redraw();
  }

  #draw(): void {
    const card = this.#card;
    const now = this.#stream.shown;
    card.update([this.#stream.about.frame_id ?? ""], "pose");
    setText(this.#empty, now ? (isKnown(now) ? "" : "no pose up to this time") : card.waiting("pose"));
    setHidden(this.#empty, !this.#empty.textContent);
    const parts = now ? splitAt(this.#points, now) : { before: [], after: [] };
    this.#shown = [...parts.before, ...parts.after];
    const top = card.noticeHeight;
    const room = { width: card.size.width, height: card.size.height - top };
    const bounds = boundsOf(this.#shown, room);
    const projection = fit(bounds, room, top);
    this.#projection = projection;
    const context = this.#canvas.begin(card.size);
    drawGrid(context, projection, card.theme);
    const named = now && this.#named;
    if (now) drawPath(context, projection, parts, now, named, card.theme);
    this.#drawPopup(named, now);
    this.#drawFooter(now, parts.before.at(-1));
  }

  /** The place of the path that the pop-up names: under the pointer, else the picked one. */
  get #named(): Point | null {
    return this.#pointed ?? this.#picked;
  }

  get #pointed(): Point | null {
    const projection = this.#projection;
    const pointer = this.#pointer;
    if (!pointer || !projection) return null;
    const found = nearestOn(this.#shown, toFloor(projection, pointer));
    const at = found && toPixel(projection, found);
    return at && Math.hypot(at.x - pointer.x, at.y - pointer.y) <= REACH ? found : null;
  }

  #drawPopup(named: Point | null, now: PoseFrame | null): void {
    if (!named || !now || !this.#projection) {
      this.#popup.hide();
      return;
    }
    const { width, height } = this.#card.size;
    const at = toPixel(this.#projection, named);
    const path = new Occupancy(width, height);
    for (const point of this.#shown) {
      const { x, y } = toPixel(this.#projection, point);
      path.mark(x, y);
    }
    const box = { x: 0, y: 0, width, height };
    this.#popup.show(describePoint(named, now), (size) => placePopup(size, box, at, at, path, [], []));
  }

  #drawFooter(now: PoseFrame | null, here: Point | undefined): void {
    const isShown = now !== null && isKnown(now);
    setText(this.#pose, isShown ? `${toPlace(now)}, ${toHeading(now)}` : "");
    setText(this.#way, isShown && here ? `${toMetres(here.way)} driven \u00B7 ${toFixed(now.time, 1)} s` : "");
  }

  #onPointer(event: PointerEvent | null): void {
    if (event?.pointerType === "touch") return;
    this.#pointer = event && pointIn(this.#card.picture, event);
    this.#card.redraw();
  }

  #onClick(event: MouseEvent): void {
    const before = this.#pointer;
    this.#pointer = pointIn(this.#card.picture, event);
    this.#pick(this.#pointed);
    this.#pointer = before;
  }

  /** In a player goes to the time of a place of the path, else keeps its pop-up open. */
  #pick(point: Point | null): void {
    const isInPlayer = this.#model.get("_picked") !== undefined;
    this.#picked = isInPlayer ? null : point;
    if (isInPlayer && point) this.#model.set("_picked", point.time);
    this.#card.redraw();
  }

  #onKey(event: KeyboardEvent): void {
    const by = WALK[event.key];
    const now = this.#stream.shown;
    if (!isPlain(event) || event.target !== this.#card.picture || !now) return;
    if (event.key === "Escape") this.#picked = null;
    else if (event.key === "Enter" && this.#picked) this.#pick(this.#picked);
    else if (by !== undefined) {
      const times = this.#shown.map(({ time }) => time);
      const at = times.findIndex((time) => time >= (this.#picked?.time ?? now.time));
      this.#picked = this.#shown[Math.min(times.length - 1, Math.max(0, at + by))] ?? null;
      if (this.#picked) this.#card.say(toSentence(describePoint(this.#picked, now)));
    } else return;
    event.preventDefault();
    this.#card.redraw();
  }
}
