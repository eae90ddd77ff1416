import { holds, type Point } from "../shared/box.ts";
import { Canvas, circle, stroke } from "../shared/canvas.ts";
import type { Credit } from "../shared/credit.ts";
import { make, set, setHidden, setText } from "../shared/dom.ts";
import { type Dragged, type Step, watchDrags } from "../shared/drag.ts";
import { isPlain, on } from "../shared/events.ts";
import { toCount, toMany, toMetres } from "../shared/format.ts";
import { type Model, onChange, setTraits } from "../shared/model.ts";
import { Popup, toSentence } from "../shared/popup.ts";
import { placePopup } from "../shared/popup_place.ts";
import { SampleCard } from "../shared/sample_card.ts";
import type { Stream } from "../shared/stream.ts";
import { MOVE_KEYS, watchZoom, ZOOM_KEYS, type Zoom } from "../shared/zoom.ts";
import { Chip } from "./chip.ts";
import { type Cloud, columnOf, drawnAt, indexOf, isColor, nearestOf, placeOf, selectedIn } from "./cloud.ts";
import { colorsOf, type Domain, domainOf, faint, toPixel as toPixelColor } from "./colors.ts";
import { Dots } from "./dots.ts";
import { drawGrid, drawLegend, drawRowsGround, drawSelection, type Legend, legendIn, roomIn, valueAt } from "./draw.ts";
import {
  AXES,
  along,
  canZoom,
  fitTo,
  type Look,
  type Projection,
  project,
  steadied,
  toPixel,
  toMetres as toPlace,
  zoomed,
} from "./projection.ts";
import { describePoint, rounded, thinnedWords, titleOf } from "./text.ts";
import { type CloudActs, Tools } from "./tools.ts";
import type { CloudAbout, CloudTraits, Selection, ViewName } from "./traits.ts";

const VIEWS: ViewName[] = ["above", "side", "behind", "rows"];
const RING = 6;
type DragKind = "move" | "box" | "band";

/** One view of a cloud widget: it wires the card, the drawing, the pop-ups, the selection and the gestures. */
export class CloudView implements Zoom, CloudActs, Dragged<DragKind> {
  readonly #model: Model<CloudTraits>;
  readonly #stream: Stream<Cloud>;
  readonly #credit: Credit;
  readonly #card: SampleCard;
  /** From the ground up: grid and scales, the points, the pointer and the selection. */
  readonly #ground: Canvas;
  readonly #points: Canvas;
  readonly #over: Canvas;
  readonly #dots = new Dots();
  readonly #tools: Tools;
  readonly #empty = make("div", "rw-empty");
  readonly #hovered: Popup;
  readonly #pinned: Popup;
  readonly #chip: Chip;
  readonly #drawnWords = make("span", "");
  readonly #unmeasured = make("span", "");
  readonly #nearest = make("span", "rw-cloud-nearest");
  readonly #tell = () => this.#drawFooter();
  #projection: Projection | null = null;
  #legend: Legend | null = null;
  #domains = new Map<string, Domain>();
  #looks = new Map<ViewName, Look>();
  #fitted = new Map<ViewName, Look>();
  #found: Uint8Array | null = null;
  /** The inputs of the last drawing, so that pointing does not draw the points again. */
  #drawnKey: unknown[] = [];
  #pointer: Point | null = null;
  /** Index in the whole cloud. */
  #pinnedIndex: number | null = null;
  #isBox = false;

  constructor(
    model: Model<CloudTraits>,
    element: HTMLElement,
    stream: Stream<Cloud>,
    credit: Credit,
    signal: AbortSignal,
  ) {
    this.#model = model;
    this.#stream = stream;
    this.#credit = credit;
    this.#card = new SampleCard(element, "cloud", model, stream, () => this.#draw(), signal);
    const { picture, footer, root } = this.#card;
    // Screen readers leave the arrow keys to it.
    picture.role = "application";
    picture.setAttribute("aria-description", "m: nearest point, v: next view, b: select by a box, arrows: move");
    this.#ground = new Canvas(picture);
    this.#points = new Canvas(picture);
    this.#over = new Canvas(picture);
    this.#chip = new Chip(
      () => this.#select({}),
      (words) => this.#card.say(words),
      signal,
    );
    this.#pinned = new Popup(picture, signal);
    this.#hovered = new Popup(picture, signal);
    picture.append(this.#empty);
    this.#tools = new Tools(this, signal);
    this.#card.addControls(...this.#tools.all);
    footer.append(this.#drawnWords, this.#unmeasured, this.#nearest);
    const traits = ["view", "color_by", "color_range", "selection", "view_range"] as const;
    onChange(model, traits, this.#card.redraw, signal);
    on(picture, "dblclick", () => this.onFit(), signal);
    on(root, "keydown", (event) => this.#onKey(event), signal);
    watchDrags(picture, this, signal);
    watchZoom(picture, this, signal);
  }

  // Actions of the user

  onView(view: ViewName): void {
    setTraits(this.#model, { view });
  }

  onColor(field: string): void {
    setTraits(this.#model, { color_by: field });
  }

  onSelect(): void {
    this.#isBox = !this.#isBox;
    this.#card.redraw();
  }

  onFit(): void {
    this.#looks.delete(this.#view);
    this.#fitted.delete(this.#view);
    this.#card.redraw();
  }

  canZoom(direction: -1 | 1): boolean {
    const look = this.#projection?.look;
    return look !== undefined && canZoom(look, direction);
  }

  /** Zooms at the pointer, by a button or a key in the middle. */
  onZoom(direction: -1 | 1): void {
    const projection = this.#projection;
    if (!projection) return;
    const isPointed = this.#pointer && this.#card.picture.matches(":hover");
    const at = isPointed && this.#pointer ? toPlace(projection, this.#pointer) : undefined;
    const look = this.#looks.get(this.#view) ?? projection.look;
    this.#looks.set(this.#view, zoomed(look, direction, at));
    this.#card.redraw();
  }

  onPoint(at: Point | null): void {
    this.#pointer = at;
    this.#card.redraw();
  }

  startsAt(at: Point, { button, pointerType, shiftKey }: PointerEvent): DragKind | null {
    if (button) return null;
    const bar = this.#legend?.bar;
    const isLegend = bar && at.x > bar.x - 8 && at.x < bar.x + bar.width + 30 && at.y > bar.y - 8;
    if (isLegend && at.y < bar.y + bar.height + 8) return "band";
    if (!this.#projection) return null;
    if (this.#isBox || shiftKey) return "box";
    // A finger scrolls the page, unless it selects.
    return pointerType === "touch" ? null : "move";
  }

  onDrag(kind: DragKind, { from, last, at }: Step): void {
    if (kind === "move") this.#onMove(at.x - last.x, at.y - last.y);
    else if (kind === "box") this.#onBox(from, at);
    else this.#onBand(from, at);
  }

  #onMove(dx: number, dy: number): void {
    const projection = this.#projection;
    if (!projection) return;
    const look = this.#looks.get(this.#view) ?? projection.look;
    const { scale } = projection;
    this.#looks.set(this.#view, { ...look, right: look.right - dx / scale, up: look.up + dy / scale });
    this.#card.redraw();
  }

  #onBox(from: Point, to: Point): void {
    const projection = this.#projection;
    if (!projection) return;
    const [ends, others] = [toPlace(projection, from), toPlace(projection, to)];
    const { right, up } = projection.axes;
    const span = 2 * projection.look.range;
    const boundsOf = (axis: typeof right, i: 0 | 1): [number, number] => {
      const bounds = [along(axis, ends[i]), along(axis, others[i])].sort((a, b) => a - b);
      return rounded(bounds as [number, number], span);
    };
    const box = { [right.name]: boundsOf(right, 0), [up.name]: boundsOf(up, 1) };
    const all: Selection = { ...this.#selection, ...box };
    // Sorted in the order in which users read them: x before y before z.
    this.#select(Object.fromEntries(Object.entries(all).sort(([one], [other]) => (one < other ? -1 : 1))));
  }

  #onBand(from: Point, to: Point): void {
    const legend = this.#legend;
    if (!legend) return;
    const bounds = [valueAt(legend, from.y), valueAt(legend, to.y)].sort((a, b) => a - b) as [number, number];
    const [low, high] = legend.domain;
    this.#select({ ...this.#selection, [this.#colorBy]: rounded(bounds, high - low) });
  }

  onTap(at: Point): void {
    const cloud = this.#stream.shown;
    if (!cloud) return;
    const i = this.#dots.at(at);
    const index = i < 0 ? null : indexOf(cloud, i);
    this.#pinnedIndex = index === this.#pinnedIndex ? null : index;
    this.#card.redraw();
  }

  #onKey(event: KeyboardEvent): void {
    if (!isPlain(event) || event.target instanceof HTMLSelectElement) return;
    const [moves, direction] = [MOVE_KEYS[event.key], ZOOM_KEYS[event.key]];
    if (moves) this.#onMove(...moves);
    else if (direction) this.onZoom(direction);
    else if (event.key === "0") this.onFit();
    else if (event.key === "b") this.onSelect();
    else if (event.key === "v") this.#turn();
    else if (event.key === "m") this.#pinNearest();
    else if (event.key === "c" && this.#hasSelection) void this.#chip.copy.copy();
    else if (event.key === "Escape" && this.#pinnedIndex !== null) this.#pin(null);
    else if (event.key === "Escape" && this.#hasSelection) this.#select({});
    else return;
    event.preventDefault();
  }

  /** Shows the next view; clouds whose points do not lie in rows skip the view of rows. */
  #turn(): void {
    const hasRows = (this.#stream.shown?.rows ?? 1) > 1;
    const views = VIEWS.filter((view) => hasRows || view !== "rows");
    this.onView(views[(views.indexOf(this.#view) + 1) % views.length] as ViewName);
  }

  #pinNearest(): void {
    const cloud = this.#stream.shown;
    const i = cloud ? nearestOf(cloud, this.#found) : -1;
    if (!cloud || i < 0) {
      this.#card.say(["no point"]);
      return;
    }
    this.#pin(indexOf(cloud, i));
    this.#card.say(toSentence(describePoint(cloud, i)));
  }

  #pin(index: number | null): void {
    this.#pinnedIndex = index;
    this.#card.redraw();
  }

  #select(selection: Selection): void {
    this.#chip.copy.reset();
    setTraits(this.#model, { selection });
    this.#card.redraw();
  }

  // Drawing

  get #view(): ViewName {
    return this.#model.get("view");
  }

  get #colorBy(): string {
    return this.#model.get("color_by");
  }

  get #selection(): Selection {
    return this.#model.get("selection");
  }

  get #hasSelection(): boolean {
    return Object.keys(this.#selection).length > 0;
  }

  #draw(): void {
    const { size, theme, noticeHeight } = this.#card;
    const { newest } = this.#credit;
    const cloud = this.#stream.shown;
    const by = cloud && columnOf(cloud, this.#colorBy) ? this.#colorBy : "";
    const domain = cloud && by && !isColor(by) ? this.#domainOf(cloud, by) : null;
    const box = roomIn(size.width, size.height, noticeHeight, domain !== null);
    const look = this.#lookIn(cloud, box);
    const key = [cloud, this.#view, by, domain?.join(), JSON.stringify([this.#selection, box, look, size]), theme];
    if (key.some((part, i) => part !== this.#drawnKey[i])) {
      this.#drawnKey = key;
      this.#legend = domain ? legendIn(box, domain) : null;
      this.#found = cloud ? selectedIn(cloud, this.#selection) : null;
      this.#drawPoints(cloud, box, look, by, domain);
    }
    this.#drawOver(cloud);
    this.#card.update([this.#stream.about.frame_id ?? "", cloud ? toMany(cloud.total, "point") : ""], "cloud");
    const fields = ["z", "distance", ...(cloud ? this.#fieldsOf(cloud) : []), ""];
    const isFitted = !this.#looks.has(this.#view) && this.#fitted.has(this.#view);
    this.#tools.update(this.#view, by, fields, (cloud?.rows ?? 1) > 1, isFitted, this.#isBox);
    set(this.#card.picture.dataset as { cursor: string }, "cursor", this.#isBox ? "box" : "move");
    setText(this.#empty, this.#wordsOnNothing(cloud));
    setHidden(this.#empty, !this.#empty.textContent);
    this.#card.texts.ask(this.#tell);
    this.#chip.put(this.#card.picture, this.#card.width);
    this.#chip.update(cloud, this.#selection, this.#found, this.#wholeCount);
    this.#credit.drawn(newest);
  }

  /** The fields with one number per point that the list lacks. */
  #fieldsOf(cloud: Cloud): string[] {
    const others = [...cloud.fields.values()].filter(({ name, size }) => size === 1 && name !== "z");
    return others.map(({ name }) => name).filter((name) => name !== "distance");
  }

  #wordsOnNothing(cloud: Cloud | null): string {
    if (!cloud) return this.#card.waiting("cloud");
    if (!cloud.total) return "a cloud without points";
    if (cloud.unmeasured === cloud.total) return `none of its ${toMany(cloud.total, "point")} was measured`;
    return this.#view === "rows" && cloud.rows <= 1 ? "this cloud does not lie in rows" : "";
  }

  #domainOf(cloud: Cloud, by: string): Domain | null {
    const given = this.#model.get("color_range");
    if (given) return given;
    const domain = domainOf(cloud, by, this.#domains.get(by) ?? null);
    if (domain) this.#domains.set(by, domain);
    return domain;
  }

  /** The look that the user chose, or one that fits all points. */
  #lookIn(cloud: Cloud | null, box: ReturnType<typeof roomIn>): Look | null {
    if (this.#view === "rows" || !cloud) return null;
    const looked = this.#looks.get(this.#view);
    if (looked) return looked;
    const range = this.#model.get("view_range");
    if (range) return { right: 0, up: 0, range };
    const fitted = steadied(this.#fitted.get(this.#view) ?? null, fitTo(cloud, AXES[this.#view], box));
    this.#fitted.set(this.#view, fitted);
    return fitted;
  }

  #drawPoints(
    cloud: Cloud | null,
    box: ReturnType<typeof roomIn>,
    look: Look | null,
    by: string,
    domain: Domain | null,
  ): void {
    const { size, theme } = this.#card;
    const ground = this.#ground.begin(size);
    this.#dots.begin(size);
    this.#projection = null;
    if (cloud) {
      const ghost = toPixelColor(theme.ghost);
      const { pixels } = colorsOf(cloud, by, domain, theme.dark, toPixelColor(theme.reading), ghost);
      const found = this.#found;
      // Fainter than the darkest color of a selected point; in the view of rows, fainter still.
      const others = this.#view === "rows" ? toPixelColor(theme.line) : faint(ghost);
      if (found) for (let i = 0; i < cloud.count; i++) if (!found[i]) pixels[i] = others;
      if (this.#view === "rows" || !look) {
        if (cloud.rows > 1) {
          drawRowsGround(ground, box, cloud, theme);
          this.#dots.placeRows(cloud, box, pixels);
        }
      } else {
        this.#projection = project(AXES[this.#view], box, look);
        drawGrid(ground, this.#projection, theme);
        this.#dots.place(cloud, this.#projection, pixels, found);
      }
    }
    if (this.#legend) drawLegend(ground, this.#legend, titleOf(by), this.#selection[by], theme);
    this.#points.begin(size);
    this.#dots.paint(this.#points.context);
  }

  /** Draws the selection and the pointer. */
  #drawOver(cloud: Cloud | null): void {
    const { size, theme, noticeHeight } = this.#card;
    const over = this.#over.begin(size);
    if (this.#projection) drawSelection(over, this.#projection, this.#selection, theme);
    const taken = this.#chip.boxes;
    const box = { x: 0, y: noticeHeight, width: size.width, height: size.height - noticeHeight };
    const show = (popup: Popup, i: number) => {
      const at = cloud && i >= 0 ? this.#pixelOf(cloud, i) : null;
      if (!cloud || !at) return popup.hide();
      circle(over, at, RING);
      stroke(over, theme.background, 4);
      circle(over, at, RING);
      stroke(over, theme.pointer, 2);
      const words = describePoint(cloud, i);
      taken.push(popup.show(words, (room) => placePopup(room, box, at, at, { count: () => 0 }, taken, [])));
    };
    const pinned = cloud ? drawnAt(cloud, this.#pinnedIndex) : -1;
    const hovered = this.#pointer && cloud ? this.#dots.at(this.#pointer) : -1;
    show(this.#pinned, pinned);
    show(this.#hovered, hovered === pinned ? -1 : hovered);
  }

  #pixelOf(cloud: Cloud, i: number): Point | null {
    const projection = this.#projection;
    if (Number.isNaN(cloud.distance[i] ?? NaN)) return null;
    if (projection) {
      const { right, up } = projection.axes;
      const at = toPixel(
        projection,
        right.sign * (cloud[right.name][i] as number),
        up.sign * (cloud[up.name][i] as number),
      );
      return holds(projection.box, at) ? at : null;
    }
    if (cloud.rows <= 1) return null;
    const { size, noticeHeight } = this.#card;
    const box = roomIn(size.width, size.height, noticeHeight, this.#legend !== null);
    const [row, column] = placeOf(cloud, i);
    const { columns, rows, step } = cloud;
    return {
      x: box.x + ((column + step / 2) / columns) * box.width,
      y: box.y + ((row + step / 2) / rows) * box.height,
    };
  }

  /** The number of selected points of the whole cloud, once Python has counted them. */
  get #wholeCount(): number | null {
    const [selection, count] = (this.#stream.about as CloudAbout).selected ?? [];
    return JSON.stringify(selection) === JSON.stringify(this.#selection) ? (count ?? null) : null;
  }

  #drawFooter(): void {
    const cloud = this.#stream.shown;
    const { pace = "" } = this.#stream.about;
    setText(this.#drawnWords, [cloud ? thinnedWords(cloud) : "", pace].filter(Boolean).join(" \u00b7 "));
    setText(this.#unmeasured, cloud?.unmeasured ? `${toCount(cloud.unmeasured)} not measured` : "");
    const nearest = cloud ? nearestOf(cloud, this.#found) : -1;
    const words = cloud && nearest >= 0 ? `nearest ${toMetres(cloud.distance[nearest] as number)} ` : "";
    const b = make("b", "rw-index", cloud && nearest >= 0 ? `[${indexOf(cloud, nearest)}]` : "");
    if (this.#nearest.textContent !== words + b.textContent) this.#nearest.replaceChildren(words, b);
  }
}
