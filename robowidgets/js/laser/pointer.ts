import type { Box, Point } from "../shared/box.ts";
import { CopyCode } from "../shared/copy.ts";
import { setHidden } from "../shared/dom.ts";
import { angleOf, OUTSIDE_LIMITS, READING, type Scan } from "../shared/frames/scan.ts";
import { setTraits } from "../shared/model.ts";
import { Popup, type PopupWords, toSentence } from "../shared/popup.ts";
import { placePopup } from "../shared/popup_place.ts";
import { toPixel } from "../shared/projection.ts";
import type { Theme } from "../shared/theme.ts";
import { keepChange } from "../shared/undo.ts";
import { ABOUT_FORMS, FORMS, type Form, toCode } from "./code.ts";
import { drawLine, drawRobot } from "./draw_area.ts";
import { drawStripPointer } from "./draw_strip.ts";
import { FormulaFoot } from "./formula_foot.ts";
import type { Depth, Host, Layer, Painter, Stage, StripPainter } from "./layer.ts";
import { shownBy } from "./mount.ts";
import { pick } from "./pick.ts";
import { sectorOf } from "./sector.ts";
import { describeRay, sourceOf } from "./text.ts";

/** Rays that the keys for a page walk. */
const FAR = 10;

const WALK: Record<string, string> = {
  ArrowRight: "next",
  ArrowUp: "next",
  ArrowLeft: "previous",
  ArrowDown: "previous",
  PageUp: "forth",
  PageDown: "back",
  m: "nearest",
  Home: "first",
  End: "last",
  Escape: "none",
};

/** The ray under the pointer and the pinned one: their lines, rings and pop-ups. */
export class PointerLayer implements Layer {
  readonly traits = ["hovered", "pinned", "formula", "angle_unit", "own_angles"] as const;
  readonly #host: Host;
  readonly #moreOf: (index: number) => string;
  readonly #foot: FormulaFoot;
  readonly #pinned: Popup;
  readonly #hovered: Popup;
  readonly #copy: CopyCode<Form>;

  /** @param moreOf a text with more about a ray */
  constructor(host: Host, moreOf: (index: number) => string) {
    this.#host = host;
    this.#moreOf = moreOf;
    this.#foot = new FormulaFoot(host.model, host.signal);
    const say = (words: string[]) => host.card.say(words);
    this.#copy = new CopyCode((form) => this.#toCode(form), say, host.signal, FORMS, ABOUT_FORMS);
    for (const element of [this.#copy.row, this.#copy.field]) element.classList.add("rw-over");
    this.#pinned = new Popup(host.card.picture, host.signal, this.#foot.element, this.#copy.row, this.#copy.field);
    this.#hovered = new Popup(host.card.picture, host.signal);
  }

  painters(): Partial<Record<Depth, Painter>> {
    return {
      pointer: (context, stage, theme) =>
        this.#each(stage.scan, (scan, index) => drawPointer(context, stage, scan, index, theme)),
    };
  }

  strip(): Partial<Record<Depth, StripPainter>> {
    return {
      pointer: (context, strip, theme) =>
        this.#each(strip.scan, (scan, index) => drawStripPointer(context, strip, scan, index, theme)),
    };
  }

  place(stage: Stage): void {
    const { scan, projection, box, occupied, labels, covered } = stage;
    const others: Box[] = [...covered];
    const center = { x: projection.centerX, y: projection.centerY };
    const show = (popup: Popup, index: number | null) => {
      if (!scan || index === null) return popup.hide();
      const end = index < scan.count ? endOf(stage, scan, index) : center;
      others.push(
        popup.show(this.#describe(scan, index, projection.viewRange), (size) =>
          placePopup(size, box, center, end, occupied, others, labels),
        ),
      );
    };
    const [pinned, hovered] = this.#indices;
    if (scan && pinned !== null) {
      this.#foot.update(scan, pinned, this.#host.stream.about);
      setHidden(this.#copy.row, pinned >= scan.count);
    }
    show(this.#pinned, pinned);
    show(this.#hovered, hovered);
  }

  onHover(point: Point | null): boolean {
    this.#setIndex("hovered", point ? this.#indexAt(point) : -1);
    return true;
  }

  onClick(point: Point): boolean {
    const index = this.#indexAt(point);
    this.#pin(index === this.#host.model.get("pinned") ? -1 : index);
    return true;
  }

  onKey({ key }: KeyboardEvent): boolean {
    if (key === "c" && this.#host.model.get("pinned") !== null) {
      this.#copy.copy();
      return true;
    }
    const to = WALK[key];
    if (to) this.#walk(to);
    else if (key === "f") this.#foot.toggleFormula();
    else if (key === "r") this.#foot.toggleUnit();
    else return false;
    return true;
  }

  /** Code for the pinned ray: its distance by its angle, or its part of the array by its index. */
  #toCode(form: Form): string {
    const { model, stage, stream } = this.#host;
    const index = model.get("pinned") ?? 0;
    if (form === "slice") return `ranges[${index}]`;
    return toCode(
      sectorOf(stage.sweep, index, index),
      form,
      stage.sweep,
      model.get("angle_offset"),
      stream.about.mount,
    );
  }

  #walk(to: string): void {
    const { model, stream, card } = this.#host;
    const scan = stream.shown;
    if (!scan?.count) return;
    const last = scan.count - 1;
    const from = model.get("pinned") ?? model.get("hovered");
    const middle = Math.floor(last / 2);
    const next = {
      next: from === null ? middle : from + 1,
      previous: from === null ? middle : from - 1,
      forth: from === null ? middle : from + FAR,
      back: from === null ? middle : from - FAR,
      first: 0,
      last,
      nearest: scan.nearest,
    };
    const index = next[to as keyof typeof next] ?? -1;
    if (to === "nearest" && index < 0) {
      card.say(["no reading"]);
      return;
    }
    const walked = to === "none" ? -1 : Math.min(last, Math.max(0, index));
    if (walked < 0) this.#pin(walked);
    else this.#setIndex("pinned", walked);
    card.say(walked < 0 ? [] : toSentence(this.#describe(scan, walked, 1)));
  }

  #describe(scan: Scan, index: number, reach: number): PopupWords {
    const { model, stream } = this.#host;
    const more = [sourceOf(scan, index, stream.about), this.#moreOf(index)].filter(Boolean).join("\n");
    return describeRay(scan, index, reach, model.get("angle_unit"), more, shownBy(model, stream.about));
  }

  /** The pinned ray, and the ray under the pointer if it is another one. */
  get #indices(): [number | null, number | null] {
    const [pinned, hovered] = [this.#host.model.get("pinned"), this.#host.model.get("hovered")];
    return [pinned, hovered === pinned ? null : hovered];
  }

  #each(scan: Scan | null, draw: (scan: Scan, index: number) => void): void {
    for (const index of this.#indices) if (scan && index !== null && index < scan.count) draw(scan, index);
  }

  #indexAt(point: Point): number {
    const scan = this.#host.stream.shown;
    return scan ? pick(this.#host.stage.projection, scan, point) : -1;
  }

  #pin(index: number): void {
    const { model, card } = this.#host;
    const before = model.get("pinned");
    this.#setIndex("pinned", index);
    if (model.get("pinned") === before) return;
    keepChange(card.picture, { words: "pinned ray", undo: () => setTraits(model, { pinned: before }) });
  }

  #setIndex(name: "hovered" | "pinned", index: number): void {
    const { model } = this.#host;
    const value = index < 0 ? null : index;
    if (model.get(name) !== value) setTraits(model, { [name]: value });
  }
}

/** Metres of a ray up to its reading or the edge of the view. */
function lengthOf({ projection }: Stage, scan: Scan, index: number): number {
  const kind = scan.kinds[index];
  const isMeasured = kind === READING || kind === OUTSIDE_LIMITS;
  return Math.min(isMeasured ? Math.max(0, scan.ranges[index] as number) : scan.maxRange, projection.viewRange);
}

/** The end of a ray in the picture: its reading, or the edge of the view. */
function endOf(stage: Stage, scan: Scan, index: number): Point {
  return toPixel(stage.projection, lengthOf(stage, scan, index), angleOf(scan, index));
}

/** Draws the ray that a pop-up names. */
function drawPointer(context: CanvasRenderingContext2D, stage: Stage, scan: Scan, index: number, theme: Theme): void {
  const { projection } = stage;
  context.setLineDash(scan.kinds[index] === READING ? [] : [4, 4]);
  drawLine(context, projection, angleOf(scan, index), 0, lengthOf(stage, scan, index), theme.pointer, 1.5);
  context.setLineDash([]);
  const end = endOf(stage, scan, index);
  context.beginPath();
  context.arc(end.x, end.y, 6, 0, 2 * Math.PI);
  context.lineWidth = 2;
  context.stroke();
  drawRobot(context, projection, theme);
}
