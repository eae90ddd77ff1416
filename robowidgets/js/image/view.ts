import { type Box, common, type Point } from "../shared/box.ts";
import { Canvas } from "../shared/canvas.ts";
import { CopyCode } from "../shared/copy.ts";
import type { Credit } from "../shared/credit.ts";
import { make, makeButton, set, setHidden, setText } from "../shared/dom.ts";
import { type Dragged, type Step, watchDrags } from "../shared/drag.ts";
import { isPlain, on } from "../shared/events.ts";
import { type Model, onChange, setTraits } from "../shared/model.ts";
import { Popup, type PopupWords, putMarked, toSentence } from "../shared/popup.ts";
import { placePopup } from "../shared/popup_place.ts";
import { SampleCard } from "../shared/sample_card.ts";
import type { Stream } from "../shared/stream.ts";
import { watchZoom, ZOOM_KEYS, type Zoom } from "../shared/zoom.ts";
import { Answers } from "./answers.ts";
import { isNumbers, type Picture, toDepth } from "./frame.ts";
import { Legend } from "./legend.ts";
import { Lit } from "./lit.ts";
import { type Dot, describeDot, dotAt, dotsOf, drawOver, type Over, wordsOf } from "./overlay.ts";
import {
  boxOf,
  fitScaleOf,
  type Look,
  lookAt,
  type Placement,
  placeBeside,
  placeIn,
  toPicture,
  zoomed,
} from "./place.ts";
import { type Region, regionOf, type Statistics } from "./region.ts";
import { Source } from "./source.ts";
import { describePixel, describeRegion, type Known, type Pixel, thinned, toCode } from "./text.ts";
import type { ImageAbout, ImageTraits } from "./traits.ts";

/** Keys that walk pixels: rows and columns. */
const WALK: Record<string, [rows: number, columns: number]> = {
  ArrowRight: [0, 1],
  ArrowLeft: [0, -1],
  ArrowDown: [1, 0],
  ArrowUp: [-1, 0],
};
/** Pixels of the screen for one of the picture from which they are drawn as squares. */
const SQUARES = 1.5;
const NOWHERE = { count: () => 0 };
const LASER = "What the laser measures on the picture (l)";

/** One view of an image widget: it wires the card, the picture, the pop-ups and the gestures. */
export class ImageView implements Zoom, Dragged<"mark" | "move"> {
  readonly #model: Model<ImageTraits>;
  readonly #stream: Stream<Picture>;
  readonly #credit: Credit;
  readonly #card: SampleCard;
  readonly #canvas: Canvas;
  readonly #source = new Source();
  readonly #legend: Legend;
  readonly #empty = make("div", "rw-empty");
  readonly #facts = make("span", "rw-image-facts");
  readonly #fit: HTMLButtonElement;
  readonly #laser: HTMLButtonElement;
  readonly #copy: CopyCode;
  readonly #marked: Popup;
  readonly #picked: Popup;
  readonly #hovered: Popup;
  readonly #lit: Lit;
  readonly #answers: Answers;
  /** The readings in the picture, on the screen. */
  #dots: Dot[] = [];
  #placement: Placement | null = null;
  #look: Look | null = null;
  #pointer: Point | null = null;
  #pixel: Pixel | null = null;
  /** While it is being marked. */
  #marking: Region | null = null;
  readonly #tell = () => this.#drawFooter();

  constructor(
    model: Model<ImageTraits>,
    element: HTMLElement,
    stream: Stream<Picture>,
    credit: Credit,
    signal: AbortSignal,
  ) {
    this.#model = model;
    this.#stream = stream;
    this.#credit = credit;
    this.#card = new SampleCard(element, "image", model, stream, () => this.#draw(), signal);
    const { picture, footer, root } = this.#card;
    // Screen readers leave the arrow keys to it.
    picture.role = "application";
    this.#canvas = new Canvas(picture);
    picture.append(this.#empty);
    const say = (words: string[]) => this.#card.say(words);
    this.#copy = new CopyCode(() => toCode(this.#region ?? [], this.#isDepth), say, signal);
    const onClose = () => this.#mark(null);
    this.#copy.row.append(makeButton("rw-close", "Mark nothing (Escape)", onClose, signal, "\u00d7"));
    for (const part of [this.#copy.row, this.#copy.field]) part.classList.add("rw-over");
    this.#marked = new Popup(picture, signal, this.#copy.row, this.#copy.field);
    this.#picked = new Popup(picture, signal);
    this.#hovered = new Popup(picture, signal);
    this.#lit = new Lit(model, this.#card.redraw, signal);
    this.#legend = new Legend(() => this.#onKeep(), signal);
    footer.append(this.#facts, this.#legend.root);
    const closer = makeButton("rw-zoom", "Zoom in (+)", () => this.onZoom(-1), signal, "+");
    const farther = makeButton("rw-zoom", "Zoom out (\u2212)", () => this.onZoom(1), signal, "\u2212");
    this.#fit = makeButton("rw-fit", "Show all of it (0)", () => this.#onFit(), signal, "Fit");
    this.#laser = makeButton("rw-image-laser", LASER, () => this.#onLaser(), signal, "Laser");
    this.#card.addControls(this.#laser, farther, closer, this.#fit);
    onChange(model, ["color_range", "region", "camera", "overlay"], this.#card.redraw, signal);
    this.#answers = new Answers(model, stream, this.#card.redraw, signal);
    on(root, "keydown", (event) => this.#onKey(event), signal);
    watchDrags(picture, this, signal);
    watchZoom(picture, this, signal);
  }

  // Actions of the user

  onZoom(direction: -1 | 1): void {
    const [placement, shown] = [this.#placement, this.#source.picture];
    if (!placement || !shown) return;
    const room = this.#room;
    const isPointed = this.#pointer && this.#card.picture.matches(":hover");
    const at = isPointed && this.#pointer ? this.#pointer : { x: room.x + room.width / 2, y: room.y + room.height / 2 };
    this.#look = zoomed(placement, direction, at, sizeOf(shown), room);
    this.#placement = placeIn(sizeOf(shown), room, this.#look);
    this.#card.redraw();
  }

  canZoom(direction: -1 | 1): boolean {
    return this.#source.picture !== null && (direction < 0 || this.#look !== null);
  }

  onPoint(at: Point | null): void {
    this.#pointer = at;
    this.#lit.light((at && dotAt(this.#dots, at)?.index) ?? null);
    this.#card.redraw();
  }

  onTap(at: Point): void {
    const pixel = this.#pixelAt(at);
    const isSame = pixel && pixel.row === this.#pixel?.row && pixel.column === this.#pixel.column;
    this.#pixel = isSame ? null : pixel;
    this.#card.redraw();
  }

  /** A drag marks a part. A drag with Shift, with the middle button, or by a finger moves the picture. */
  startsAt(_at: Point, event: PointerEvent): "mark" | "move" | null {
    const isTouch = event.pointerType === "touch";
    // A finger scrolls the page if all of the picture is in view. The middle button would scroll it, too.
    if (event.button > 1 || (isTouch && !this.#look)) return null;
    if (event.button === 1) event.preventDefault();
    return isTouch || event.shiftKey || event.button === 1 ? "move" : "mark";
  }

  onDrag(kind: "mark" | "move", { from, last, at, ends }: Step): void {
    const [placement, picture] = [this.#placement, this.#source.picture];
    if (!placement || !picture) return;
    if (kind === "move") {
      const moved = { ...placement, left: placement.left + at.x - last.x, top: placement.top + at.y - last.y };
      if (this.#look) this.#look = lookAt(moved, this.#room);
    } else {
      const region = regionOf(toPicture(placement, from), toPicture(placement, at), picture.rows, picture.columns);
      this.#marking = ends ? null : region;
      this.#copy.reset();
      if (ends) this.#mark(region);
    }
    this.#card.redraw();
  }

  #onFit(): void {
    this.#look = null;
    this.#card.redraw();
  }

  #onLaser(): void {
    setTraits(this.#model, { overlay: !this.#model.get("overlay") });
    this.#card.redraw();
  }

  #onKeep(): void {
    setTraits(this.#model, { color_range: this.#model.get("color_range") ? null : [...this.#source.scale] });
    this.#card.redraw();
  }

  #onKey(event: KeyboardEvent): void {
    const walk = WALK[event.key];
    if (walk && !event.ctrlKey && !event.metaKey && !event.altKey) this.#walk(walk, event.shiftKey ? 10 : 1);
    else if (!isPlain(event)) return;
    else if (event.key === "Escape" && (this.#pixel || this.#region)) this.#clear();
    else if (event.key === "c" && this.#region) void this.#copy.copy();
    else if (ZOOM_KEYS[event.key]) this.onZoom(ZOOM_KEYS[event.key] as -1 | 1);
    else if (event.key === "0") this.#onFit();
    else if (event.key === "l" && !this.#laser.hidden) this.#onLaser();
    else if (event.key === "s" && this.#source.picture && isNumbers(this.#source.picture)) this.#onKeep();
    else return;
    event.preventDefault();
  }

  /** Clears the pixel first, then the region. */
  #clear(): void {
    if (this.#pixel) this.#pixel = null;
    else this.#mark(null);
    this.#card.redraw();
  }

  #mark(region: Region | null): void {
    setTraits(this.#model, { region });
    this.#card.redraw();
  }

  #walk([rows, columns]: readonly [number, number], by: number): void {
    const { picture } = this.#source;
    if (!picture) return;
    const clamp = (value: number, size: number) => Math.min(size - 1, Math.max(0, value));
    const { row, column } = this.#pixel ?? { row: picture.rows >> 1, column: picture.columns >> 1 };
    const next = { row: clamp(row + by * rows, picture.rows), column: clamp(column + by * columns, picture.columns) };
    this.#pixel = this.#pixel ? next : { row, column };
    this.#card.say(toSentence(this.#wordsOn(this.#pixel, picture)));
    this.#card.redraw();
  }

  // Values of pixels

  #knownOf(pixel: Pixel, picture: Picture): Known | null {
    const known = this.#source.valuesAt(pixel, this.#about);
    const values = known?.isExact ? undefined : this.#answers.valuesAt(pixel, picture);
    if (!values) return known;
    const { depthScale } = picture;
    return { values: depthScale ? [toDepth(values[0] ?? NaN, depthScale)] : values, isExact: true };
  }

  #statisticsOf(region: number[], picture: Picture): Statistics | null {
    const found = this.#source.statistics(region, this.#about);
    return found?.isExact || this.#marking ? found : (this.#answers.statistics(region, picture) ?? found);
  }

  #wordsOn(pixel: Pixel, picture: Picture): PopupWords {
    return describePixel(pixel, this.#knownOf(pixel, picture), picture, this.#about, this.#model.get("camera"));
  }

  // Drawing

  get #about(): ImageAbout {
    return this.#stream.about;
  }

  /** The overlay of the picture. */
  get #over(): Over | undefined {
    return this.#model.get("overlay") ? this.#about.over : undefined;
  }

  get #region(): Region | null {
    return this.#marking ?? this.#model.get("region");
  }

  get #isDepth(): boolean {
    return (this.#source.picture?.depthScale ?? 0) > 0;
  }

  /** Of the picture, below the notice. */
  get #room(): Box {
    const { size, noticeHeight } = this.#card;
    return { x: 0, y: noticeHeight, width: size.width, height: Math.max(1, size.height - noticeHeight) };
  }

  #pixelAt(at: Point): Pixel | null {
    const [placement, picture] = [this.#placement, this.#source.picture];
    if (!placement || !picture) return null;
    const place = toPicture(placement, at);
    const [row, column] = [Math.floor(place.row), Math.floor(place.column)];
    return row >= 0 && column >= 0 && row < picture.rows && column < picture.columns ? { row, column } : null;
  }

  #draw(): void {
    const [card, source] = [this.#card, this.#source];
    const { shown } = this.#stream;
    const { newest } = this.#credit;
    const isNothing = !shown || this.#about.nothing === true;
    const { theme } = card;
    if (!isNothing) source.paint(shown, this.#model.get("color_range"), theme.dark, card.redraw);
    const picture = isNothing ? null : source.picture;
    const context = this.#canvas.begin(card.size);
    this.#placement = null;
    this.#dots = [];
    if (picture) this.#drawPicture(context, picture);
    card.update(picture ? [this.#sizeWords(picture), this.#about.frame_id ?? ""] : [], "picture");
    setText(this.#empty, !shown ? card.waiting("picture") : isNothing ? "no picture up to this time" : source.problem);
    setHidden(this.#empty, !this.#empty.textContent || (Boolean(picture) && !source.problem));
    set(this.#fit, "disabled", this.#look === null);
    const isOver = this.#model.get("overlay");
    setHidden(this.#laser, isOver && !this.#about.over);
    set(this.#laser, "ariaPressed", String(isOver));
    this.#drawPopups(picture);
    card.texts.ask(this.#tell);
    // The picture of a file is on the screen once it is unpacked.
    if (isNothing || !source.isBehind(shown)) this.#credit.drawn(newest);
  }

  #drawPicture(context: CanvasRenderingContext2D, picture: Picture): void {
    const { theme } = this.#card;
    const room = this.#room;
    const placement = placeIn(sizeOf(picture), room, this.#look);
    this.#placement = placement;
    const { scale, left, top } = placement;
    context.save();
    context.beginPath();
    context.rect(room.x, room.y, room.width, room.height);
    context.clip();
    const box = boxOf(placement, [0, picture.rows, 0, picture.columns]);
    context.fillStyle = theme.area;
    context.fillRect(box.x, box.y, box.width, box.height);
    const { canvas } = this.#source;
    context.imageSmoothingEnabled = scale * picture.every < SQUARES && !isNumbers(picture);
    // The last rows and columns that the page has stand for fewer.
    context.beginPath();
    context.rect(box.x, box.y, box.width, box.height);
    context.clip();
    const wide = canvas.width * picture.every * scale;
    const high = canvas.height * picture.every * scale;
    const isFile = canvas.width * picture.every > picture.columns + picture.every;
    context.drawImage(canvas, left, top, isFile ? box.width : wide, isFile ? box.height : high);
    const over = this.#over;
    this.#dots = over ? dotsOf(over, placement) : [];
    void this.#lit.follow(over?.laser ?? "");
    if (over) drawOver(context, over, this.#dots, this.#lit.index, placement, common(room, box), theme);
    this.#drawMarks(context, placement, picture);
    context.restore();
  }

  #drawMarks(context: CanvasRenderingContext2D, placement: Placement, picture: Picture): void {
    const { theme } = this.#card;
    const outline = (box: Box, width: number) => {
      for (const [color, wide] of [
        [theme.background, width + 2],
        [theme.pointer, width],
      ] as const) {
        context.strokeStyle = color;
        context.lineWidth = wide;
        context.strokeRect(box.x, box.y, box.width, box.height);
      }
    };
    if (this.#region) outline(boxOf(placement, this.#region), 2);
    const isOnDot = this.#pointer !== null && dotAt(this.#dots, this.#pointer) !== null;
    const hovered = this.#marking || !this.#pointer || isOnDot ? null : this.#pixelAt(this.#pointer);
    for (const pixel of [this.#pixel, hovered]) {
      if (!pixel || pixel.row >= picture.rows || pixel.column >= picture.columns) continue;
      const { row, column } = pixel;
      const box = boxOf(placement, [row, row + 1, column, column + 1]);
      const grow = Math.max(0, (8 - box.width) / 2);
      outline({ x: box.x - grow, y: box.y - grow, width: box.width + 2 * grow, height: box.height + 2 * grow }, 1.5);
    }
  }

  #drawPopups(picture: Picture | null): void {
    const placement = this.#placement;
    const hovered = this.#marking || !this.#pointer || !picture ? null : this.#pixelAt(this.#pointer);
    const others: Box[] = [];
    const room = this.#room;
    const region = this.#region;
    const isThere = (pixel: Pixel | null): pixel is Pixel =>
      Boolean(pixel && picture && pixel.row < picture.rows && pixel.column < picture.columns);
    if (picture && placement && region) {
      const box = boxOf(placement, region);
      const words = describeRegion(region, this.#statisticsOf(region, picture), picture, this.#about);
      setHidden(this.#copy.row, this.#marking !== null);
      others.push(box);
      const isBelow = putMarked(this.#marked.element, this.#card.picture, this.#card.width);
      const taken = this.#marked.show(words, (size) => (isBelow ? { x: 0, y: 0 } : placeBeside(size, room, box)));
      if (!isBelow) others.push(taken);
    } else this.#marked.hide();
    const pointed = this.#pointer && !this.#marking ? dotAt(this.#dots, this.#pointer) : null;
    const lit = pointed ?? this.#dots.find(({ index }) => index === this.#lit.index);
    for (const [popup, pixel] of [
      [this.#picked, this.#pixel],
      [this.#hovered, isThere(this.#pixel) && isThere(hovered) && isSame(this.#pixel, hovered) ? null : hovered],
    ] as const) {
      if (popup === this.#hovered && lit) {
        others.push(
          popup.show(describeDot(lit), (size) => placePopup(size, room, lit.at, lit.at, NOWHERE, others, [])),
        );
        continue;
      }
      if (!picture || !placement || !isThere(pixel)) {
        popup.hide();
        continue;
      }
      const { x, y, width, height } = boxOf(placement, [pixel.row, pixel.row + 1, pixel.column, pixel.column + 1]);
      const at = { x: x + width / 2, y: y + height / 2 };
      others.push(
        popup.show(this.#wordsOn(pixel, picture), (size) => placePopup(size, room, at, at, NOWHERE, others, [])),
      );
    }
  }

  #sizeWords({ rows, columns }: Picture): string {
    return `${columns} \u00D7 ${rows} ${this.#about.encoding ?? ""}`.trim();
  }

  #drawFooter(): void {
    const { picture, scale, nothing } = this.#source;
    const isScaled = picture !== null && isNumbers(picture);
    const kept = this.#model.get("color_range") !== null;
    this.#legend.update(isScaled ? scale : null, kept, this.#isDepth, nothing, this.#card.theme.dark);
    const over = this.#over;
    const facts = picture ? [thinned(picture) && `${thinned(picture)} shown`, this.#about.pace ?? ""] : [];
    if (picture && over) facts.push(wordsOf(over));
    const room = this.#room;
    const zoom = this.#placement && picture ? this.#placement.scale / fitScaleOf(sizeOf(picture), room) : 1;
    if (zoom > 1.01) facts.push(`${zoom.toFixed(1)}\u00D7`);
    const said = facts.filter(Boolean).join(" \u00B7 ");
    setText(this.#facts, said || (picture && !this.#region ? "drag to mark a region" : ""));
  }
}

function sizeOf({ rows, columns }: Picture) {
  return { width: columns, height: rows };
}

function isSame(one: Pixel, other: Pixel): boolean {
  return one.row === other.row && one.column === other.column;
}
