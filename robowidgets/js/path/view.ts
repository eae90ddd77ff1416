import type { Point as Pixel } from "../shared/box.ts";
import { Reader, toBytes } from "../shared/bytes.ts";
import { Canvas, write } from "../shared/canvas.ts";
import { make, set, setHidden, setText } from "../shared/dom.ts";
import { type Step, watchDrags } from "../shared/drag.ts";
import { isPlain, on } from "../shared/events.ts";
import { type Bounds, drawFloor, fit, type Place, type Projection, toFloor, toPixel } from "../shared/floor.ts";
import { toDegrees, toFixed, toMany, toMetres } from "../shared/format.ts";
import { lacksKernel, type Model, onChange, setTraits } from "../shared/model.ts";
import { Occupancy } from "../shared/occupancy.ts";
import { Popup, type PopupWords, toSentence } from "../shared/popup.ts";
import { placePopup } from "../shared/popup_place.ts";
import { SampleCard } from "../shared/sample_card.ts";
import type { Stream } from "../shared/stream.ts";
import { textFont } from "../shared/theme.ts";
import type { Picking } from "../shared/traits.ts";
import { MOVE_KEYS, watchZoom, ZOOM_KEYS } from "../shared/zoom.ts";
import { boundsOfLook, canZoom, type Look, lookOf, zoomed } from "./camera.ts";
import { drawGrid, drawPath } from "./draw.ts";
import { drawMap, drawMeasure, placeOf, type Shown, spotsOf } from "./draw_layers.ts";
import { describeCell, factOf, gridsFrom, sureness } from "./facts.ts";
import type { Ground } from "./ground.ts";
import { cellAt, type LayerAbout, type LayerState, robotOf, toTracks } from "./layers.ts";
import { Panel, type Row } from "./panel.ts";
import { boundsOf, isKnown, nearestOn, type Point, type PoseFrame, splitAt, type TimedPose, toPoints } from "./path.ts";
import { describePoint, toPose } from "./text.ts";
import { type Measured, Tools } from "./tools.ts";
import type { PathTraits, PlacedShape } from "./traits.ts";

/**
 * Greatest distance in pixels of the pointer from a path for a pop-up; less on a map, whose cells have pop-ups, too.
 */
const [REACH, REACH_ON_MAP] = [40, 12];
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
/** Width of a card from which the list of layers stands next to the map at first. */
const BESIDE = 640;
const PANEL = 270;
/** Metres from side to side that following shows unless the user zoomed. */
const NEAR = 12;

/** One view of a path widget: it wires the card, the drawing, the pop-up and the gestures. */
export class PathView {
  readonly #model: Model<PathTraits & Picking>;
  readonly #stream: Stream<PoseFrame>;
  readonly #card: SampleCard;
  readonly #canvas: Canvas;
  readonly #popup: Popup;
  readonly #tools: Tools;
  readonly #panel: Panel;
  readonly #ground: Ground;
  readonly #empty = make("div", "rw-empty");
  readonly #pose = make("span", "rw-strong");
  readonly #way = make("span", "");
  #projection: Projection | null = null;
  #points: Point[] = [];
  #tracks = new Map<number, Point[]>();
  /** The layers on show. */
  #layers: Shown[] = [];
  /** The paths on show that have pop-ups, each up to the present pose and after it; the robot's first. */
  #ways: { name: string; points: Point[] }[] = [];
  #pointer: Place | null = null;
  #picked: Point | null = null;
  #look: Look | null = null;
  #isOpen: boolean | null = null;
  #isMeasuring = false;
  #measured: Measured | null = null;
  /** Updates the texts about the drawing. */
  #said = () => {};
  readonly #tell = () => this.#said();

  constructor(
    model: Model<PathTraits & Picking>,
    element: HTMLElement,
    stream: Stream<PoseFrame>,
    ground: Ground,
    signal: AbortSignal,
  ) {
    this.#model = model;
    this.#stream = stream;
    this.#ground = ground;
    this.#card = new SampleCard(element, "path", model, stream, () => this.#draw(), signal);
    const { picture, footer, root } = this.#card;
    // Screen readers leave the arrow keys to it.
    picture.role = "application";
    this.#canvas = new Canvas(picture);
    this.#popup = new Popup(picture, signal);
    this.#panel = new Panel(
      (name) => this.#toggle(name),
      (frame) => this.onFrame(frame),
      signal,
    );
    this.#tools = new Tools(this, signal);
    this.#card.addControls(...this.#tools.all);
    picture.append(this.#empty);
    footer.append(this.#pose, this.#way);
    onChange(model, ["_path", "_tracks"], () => this.#onPath(), signal);
    onChange(model, ["_grids"], () => this.#onGrids(), signal);
    onChange(model, ["_map", "hidden", "follow", "frame"], this.#card.redraw, signal);
    on(picture, "dblclick", () => !this.#isMeasuring && this.onFit(), signal);
    on(root, "keydown", (event) => this.#onKey(event), signal);
    watchDrags(picture, this, signal);
    watchZoom(picture, this, signal);
    this.#onPath();
    this.#onGrids();
  }

  // Actions of the user

  onFollow(): void {
    setTraits(this.#model, { follow: !this.#model.get("follow") });
    this.#card.redraw();
  }

  onMeasure(): void {
    this.#isMeasuring = !this.#isMeasuring;
    this.#measured = null;
    this.#card.redraw();
  }

  onLayers(): void {
    this.#isOpen = Boolean(this.#panel.root.hidden);
    this.#card.redraw();
  }

  onFit(): void {
    this.#look = null;
    if (this.#model.get("follow")) setTraits(this.#model, { follow: false });
    this.#card.redraw();
  }

  onFrame(frame: string): void {
    this.#look = this.#measured = this.#picked = null;
    // Layers that are already drawn in it are on show at once, also without a kernel.
    setTraits(this.#model, { frame });
    this.#card.redraw();
  }

  canZoom(direction: -1 | 1): boolean {
    return this.#projection !== null && canZoom(this.#look ?? lookOf(this.#projection.bounds), direction);
  }

  /** Zooms at the pointer, by a button or a key in the middle. */
  onZoom(direction: -1 | 1): void {
    const projection = this.#projection;
    if (!projection) return;
    const isPointed = this.#pointer && this.#card.picture.matches(":hover") && !this.#model.get("follow");
    const look = this.#look ?? lookOf(projection.bounds);
    this.#look = zoomed(look, direction, isPointed && this.#pointer ? toFloor(projection, this.#pointer) : look);
    this.#card.redraw();
  }

  #onMove(dx: number, dy: number): void {
    const projection = this.#projection;
    if (!projection) return;
    const look = this.#look ?? lookOf(projection.bounds);
    this.#look = { ...look, x: look.x - dx / projection.scale, y: look.y + dy / projection.scale };
    if (this.#model.get("follow")) setTraits(this.#model, { follow: false });
    this.#card.redraw();
  }

  onPoint(at: Pixel | null): void {
    this.#pointer = at;
    this.#card.redraw();
  }

  /** A finger scrolls the page, unless it measures. */
  startsAt(_at: Pixel, { button, pointerType }: PointerEvent): "measure" | "move" | null {
    if (button || (pointerType === "touch" && !this.#isMeasuring)) return null;
    return this.#isMeasuring ? "measure" : "move";
  }

  onDrag(kind: "measure" | "move", { from, last, at }: Step): void {
    if (kind === "move") {
      this.#onMove(at.x - last.x, at.y - last.y);
    } else if (this.#projection) {
      this.#measured = { from: toFloor(this.#projection, from), to: toFloor(this.#projection, at) };
      this.#tellMeasured();
    }
  }

  onTap(at: Pixel): void {
    if (this.#isMeasuring && this.#projection) {
      const place = toFloor(this.#projection, at);
      const isSecond = this.#measured && !this.#measured.to;
      this.#measured = isSecond ? { from: this.#measured?.from ?? place, to: place } : { from: place, to: null };
      this.#tellMeasured();
      return;
    }
    const before = this.#pointer;
    this.#pointer = at;
    this.#pick(this.#pointed?.point ?? null);
    this.#pointer = before;
  }

  #tellMeasured(): void {
    const { from, to } = this.#measured ?? {};
    if (from && to) this.#card.say([measureWords(from, to)]);
    this.#card.redraw();
  }

  #toggle(name: string): void {
    const hidden = this.#model.get("hidden");
    const others = hidden.filter((one) => one !== name);
    setTraits(this.#model, { hidden: others.length < hidden.length ? others : [...hidden, name] });
    this.#card.redraw();
  }

  // Data from Python

  #onPath(): void {
    this.#points = toPoints(this.#model.get("_path"));
    const bytes = toBytes(this.#model.get("_tracks"));
    this.#tracks = toTracks(bytes && new Reader(bytes));
    this.#card.redraw();
  }

  #onGrids(): void {
    const [first] = this.#stream.moments;
    const { layers = [] } = first ? this.#stream.frameOf(first) : {};
    void this.#ground.take(this.#model.get("_grids"), layers, this.#card.redraw);
  }

  /** The layers on show at the time of a frame. */
  #toShown(now: PoseFrame | null): Shown[] {
    const { layers = [] } = this.#model.get("_map");
    const hidden = new Set(this.#model.get("hidden"));
    const states = new Map<number, LayerState>(now?.layers.map((state) => [state.number, state]));
    const visible = layers.filter((about) => !hidden.has(about.name) && this.#frameOf(about) === this.#frame);
    const robot = robotOf(visible, states);
    return visible.flatMap((about) => {
      const state = states.get(about.number);
      if (!state || !now) return [];
      const parts = this.#wayOf(about, state, now);
      return [{ about, state, ...parts, isRobot: about === robot }];
    });
  }

  #wayOf(about: LayerAbout, state: LayerState, now: PoseFrame): { before: Point[]; after: Point[] } {
    const track = this.#tracks.get(about.number);
    if (about.kind !== "pose" || !track) return { before: [], after: [] };
    return splitAt(track, { x: state.x, y: state.y, yaw: state.yaw, time: now.time });
  }

  // Drawing

  get #hasLayers(): boolean {
    return Boolean(this.#model.get("_map").layers?.length);
  }

  /** The shapes of the program that have a place in the frame on show. */
  get #shapes(): PlacedShape[] {
    const { shapes = [], frame_id = "" } = this.#stream.about;
    return this.#frame === frame_id ? shapes : [];
  }

  /** The frames that have layers: nothing joins them, so that each is a separate map. */
  get #frames(): string[] {
    return [...new Set((this.#model.get("_map").layers ?? []).flatMap(({ frame }) => frame ?? []))];
  }

  /** The frame on show: the user's choice if something is drawn in it, else the frame of the map. */
  get #frame(): string {
    const asked = this.#model.get("frame");
    return this.#frames.includes(asked) ? asked : (this.#stream.about.frame_id ?? "");
  }

  #frameOf({ frame }: LayerAbout): string {
    return frame ?? this.#stream.about.frame_id ?? "";
  }

  #draw(): void {
    const card = this.#card;
    const now = this.#stream.shown;
    const hasLayers = this.#hasLayers;
    this.#layers = hasLayers ? this.#toShown(now) : [];
    const robot = this.#layers.find(({ isRobot }) => isRobot);
    const here: TimedPose | null = robot ? { ...robot.state, time: now?.time ?? NaN } : now;
    const parts = now && !hasLayers ? splitAt(this.#points, now) : { before: [], after: [] };
    this.#ways = hasLayers
      ? [...this.#layers]
          .sort((a, b) => Number(b.isRobot) - Number(a.isRobot))
          .map(({ about, before, after, isRobot }) => ({
            name: about.name,
            points: isRobot ? [...before, ...after] : before,
          }))
      : [{ name: "", points: [...parts.before, ...parts.after] }];
    const isBeside = this.#placePanel(hasLayers);
    const top = card.noticeHeight;
    const room = { width: card.size.width - (isBeside ? PANEL : 0), height: card.size.height - top };
    const projection = fit(this.#boundsIn(room, here), room, top);
    this.#projection = projection;
    const context = this.#canvas.begin(card.size);
    const named = now ? (this.#pointed?.point ?? this.#picked) : null;
    if (hasLayers) {
      drawFloor(context, projection, card.theme);
      const scene = { layers: this.#layers, ground: this.#ground, shapes: this.#shapes, now: here ?? NOWHERE, named };
      drawMap(context, projection, scene, card.theme);
    } else {
      drawGrid(context, projection, card.theme);
      if (now) drawPath(context, projection, parts, now, named, card.theme);
    }
    this.#drawMeasured(context, projection);
    this.#drawPopup(named, here);
    card.update([this.#frame], "pose");
    const isEmpty = !now || (!isKnown(now) && !hasLayers);
    setText(this.#empty, now ? (isEmpty ? "no pose up to this time" : "") : card.waiting("pose"));
    setHidden(this.#empty, !this.#empty.textContent);
    this.#updateTools(hasLayers);
    const last = robot ? robot.before.at(-1) : parts.before.at(-1);
    this.#said = () => {
      this.#updatePanel(now, robot);
      this.#drawFooter(here, last, robot);
    };
    card.texts.ask(this.#tell);
  }

  /** The floor on show: all of it, the part that the user chose, or the robot in the middle. */
  #boundsIn(room: { width: number; height: number }, here: Place | null): Bounds {
    const isFollowing = this.#model.get("follow") && here && isKnown(here);
    const all = () => boundsOf(this.#places(), room);
    if (isFollowing) {
      const width = this.#look?.width ?? Math.min(NEAR, lookOf(all()).width);
      return boundsOfLook({ x: here.x, y: here.y, width }, room);
    }
    return this.#look ? boundsOfLook(this.#look, room) : all();
  }

  /** All places that are on show. */
  #places(): Place[] {
    const places: Place[] = this.#ways.flatMap(({ points }) => points);
    for (const { about, state } of this.#layers) {
      if (about.kind === "grid") places.push(...this.#ground.cornersOf(state));
      else if (isKnown(state)) places.push(state);
      places.push(...state.points);
    }
    for (const shape of this.#hasLayers ? this.#shapes : [])
      places.push(...spotsOf(shape).map((spot) => placeOf(shape, spot)));
    return places;
  }

  #drawMeasured(context: CanvasRenderingContext2D, projection: Projection): void {
    const { from, to } = this.#measured ?? {};
    if (!from) return;
    const end = to ?? (this.#pointer ? toFloor(projection, this.#pointer) : from);
    const { theme } = this.#card;
    drawMeasure(context, projection, from, end, theme);
    const at = toPixel(projection, { x: (from.x + end.x) / 2, y: (from.y + end.y) / 2 });
    const font = `600 ${textFont(theme)}`;
    write(context, measureWords(from, end), at.x, at.y - 12, theme.pointer, font, "center", theme.background);
  }

  /** The place of a path under the pointer. */
  get #pointed(): { point: Point; name: string } | null {
    const projection = this.#projection;
    const pointer = this.#pointer;
    if (!pointer || !projection || this.#isMeasuring) return null;
    let [found, least]: [{ point: Point; name: string } | null, number] = [null, Infinity];
    for (const { name, points } of this.#ways) {
      const point = nearestOn(points, toFloor(projection, pointer));
      const at = point && toPixel(projection, point);
      const away = at ? Math.hypot(at.x - pointer.x, at.y - pointer.y) : Infinity;
      // The robot's path if two lie on each other.
      if (point && away <= (this.#hasLayers ? REACH_ON_MAP : REACH) && away < least - 3)
        [found, least] = [{ point, name }, away];
    }
    return found;
  }

  #drawPopup(named: Point | null, now: TimedPose | null): void {
    const projection = this.#projection;
    const words = named && now ? this.#wordsOf(named, now) : this.#cellWords();
    const place = named ?? (projection && this.#pointer ? toFloor(projection, this.#pointer) : null);
    if (!words || !projection || !place) {
      this.#popup.hide();
      return;
    }
    const { width, height } = this.#card.size;
    const at = toPixel(projection, place);
    const path = new Occupancy(width, height);
    for (const { points } of this.#ways) {
      for (const point of points) {
        const { x, y } = toPixel(projection, point);
        path.mark(x, y);
      }
    }
    const box = { x: 0, y: 0, width: width - (this.#isBeside ? PANEL : 0), height };
    this.#popup.show(words, (size) => placePopup(size, box, at, at, path, [], []));
  }

  #wordsOf(named: Point, now: TimedPose): PopupWords {
    const words = describePoint(named, now);
    const name = this.#pointed?.name ?? "";
    return name ? { ...words, details: `${words.details}\n${name}` } : words;
  }

  /** The texts about the cell under the pointer; null outside of all grids. */
  #cellWords(): PopupWords | null {
    const [projection, pointer] = [this.#projection, this.#pointer];
    if (!projection || !pointer || this.#isMeasuring || !this.#stream.shown) return null;
    const at = toFloor(projection, pointer);
    const { west, east, south, north } = projection.bounds;
    if (at.x < west || at.x > east || at.y < south || at.y > north) return null;
    const robot = this.#layers.find(({ isRobot }) => isRobot);
    for (const grid of gridsFrom(this.#layers)) {
      const shown = this.#ground.gridOf(grid.state);
      const cell = shown && cellAt(shown.cells, shown.corner, at);
      if (cell) return describeCell(grid, shown.cells, cell, at, robot);
    }
    return null;
  }

  // The list of layers

  get #isBeside(): boolean {
    return !this.#panel.root.hidden && this.#card.width >= BESIDE;
  }

  /** Puts the list next to the map, or below it in a narrow card; returns true if it is next to the map. */
  #placePanel(hasLayers: boolean): boolean {
    const { picture, width } = this.#card;
    const { root } = this.#panel;
    setHidden(root, !hasLayers || !(this.#isOpen ?? width >= BESIDE));
    const isBeside = width >= BESIDE;
    if (isBeside && root.parentElement !== picture) picture.append(root);
    else if (!isBeside && root.previousElementSibling !== picture) picture.after(root);
    root.classList.toggle("rw-layers-beside", isBeside);
    root.style.top = isBeside ? `${this.#card.noticeHeight}px` : "";
    this.#card.root.classList.toggle("rw-map", hasLayers);
    return this.#isBeside;
  }

  #updateTools(hasLayers: boolean): void {
    const { all, fit, follow, frame, layers, measure } = this.#tools;
    const isFollowing = this.#model.get("follow");
    for (const one of all) if (one !== frame) setHidden(one, !hasLayers);
    // A path alone is zoomed and measured too, by wheel and keys.
    if (!hasLayers) setHidden(fit, !this.#look && !isFollowing);
    set(fit, "disabled", !this.#look && !isFollowing);
    set(follow, "ariaPressed", String(isFollowing));
    set(measure, "ariaPressed", String(this.#isMeasuring));
    set(layers, "ariaPressed", String(!this.#panel.root.hidden));
    setText(layers, this.#panel.root.hidden ? ["Layers", ...this.#countMissing()].join(", ") : "Layers");
    set(this.#card.picture.dataset, "cursor", this.#isMeasuring ? "measure" : "");
    const { frames = [] } = this.#model.get("_map");
    // Without a kernel, frames that are already drawn.
    if (hasLayers) this.#tools.updateFrames(lacksKernel(this.#model) ? this.#frames : frames, this.#frame);
    else setHidden(frame, true);
  }

  /**
   * Texts about requested layers that are not drawn, or in other frames; scans, which are added automatically, do not
   * count.
   */
  #countMissing(): string[] {
    const { missing = {} } = this.#stream.about;
    const asked = (this.#model.get("_map").layers ?? []).filter(({ kind }) => kind !== "scan" && kind !== "cone");
    const lost = asked.filter(({ name }) => missing[name]).length;
    const apart = new Set(asked.map((about) => this.#frameOf(about)).filter((frame) => frame !== this.#frame)).size;
    return [lost ? `${lost} not drawn` : "", apart ? `and ${toMany(apart, "other frame")}` : ""].filter(Boolean);
  }

  #updatePanel(now: PoseFrame | null, robot: Shown | undefined): void {
    if (this.#panel.root.hidden || !now) return;
    const { layers = [] } = this.#model.get("_map");
    const { missing = {} } = this.#stream.about;
    const frame = this.#frame;
    const hidden = new Set(this.#model.get("hidden"));
    const shapes = [...new Set([...this.#shapes.map(({ name }) => name)])];
    const names = new Set(layers.map(({ name }) => name));
    const lost = Object.keys(missing).filter((name) => !names.has(name));
    const rows: Row[] = [...shapes, ...lost].map((name) => ({
      name,
      kind: "shape",
      isRobot: false,
      fact: missing[name] ?? "drawn by the program",
      isThere: !missing[name],
      isOn: true,
    }));
    const group = (about: LayerAbout) =>
      this.#frameOf(about) === frame ? 0 : 1 + this.#frames.indexOf(this.#frameOf(about));
    const rank = (about: LayerAbout) =>
      ORDER.indexOf(about.kind) - (about === robot?.about ? 0.5 : 0) + ORDER.length * group(about);
    const named = new Set<string>();
    for (const about of [...layers].sort((a, b) => rank(a) - rank(b))) {
      const shown = this.#layers.find((one) => one.about === about);
      const other = this.#frameOf(about) === frame ? "" : this.#frameOf(about);
      const isFirst = Boolean(other && !missing[about.name] && !named.has(other));
      if (isFirst) named.add(other);
      const apart = isFirst ? "nothing joins it to this frame" : `in the frame ${other}, too`;
      const why = missing[about.name] || (other && apart);
      const fact = shown ? factOf(shown, robot, this.#ground, now.time) : "";
      rows.push({
        name: about.name,
        kind: about.kind,
        isRobot: about === robot?.about,
        fact: hidden.has(about.name) ? "not shown" : why || fact || "nothing up to this time",
        isThere: shown !== undefined || hidden.has(about.name),
        isOn: !hidden.has(about.name),
        ...(isFirst ? { other } : {}),
      });
    }
    this.#panel.update(rows, frame ? [`all in the frame ${frame}`, "each by the transforms at its own stamp"] : []);
  }

  #drawFooter(now: TimedPose | null, here: Point | undefined, robot: Shown | undefined): void {
    const isShown = now !== null && isKnown(now);
    const sure = robot ? sureness(robot) : "";
    setText(this.#pose, isShown ? [toPose(now), sure].filter(Boolean).join(" ") : "");
    const time = now ? `${toFixed(now.time, 1)} s` : "";
    setText(this.#way, isShown && here ? `${toMetres(here.way)} driven \u00B7 ${time}` : "");
  }

  // Pointer and keys

  /** In a player goes to the time of a place of the path, else keeps its pop-up open. */
  #pick(point: Point | null): void {
    const isInPlayer = this.#model.get("_picked") !== undefined;
    this.#picked = isInPlayer ? null : point;
    if (isInPlayer && point) this.#model.set("_picked", point.time);
    this.#card.redraw();
  }

  #onKey(event: KeyboardEvent): void {
    const now = this.#stream.shown;
    if (!isPlain(event) || event.target !== this.#card.picture || !now) return;
    if (!this.#takeKey(event, now)) return;
    event.preventDefault();
    this.#card.redraw();
  }

  #takeKey({ key, shiftKey }: KeyboardEvent, now: PoseFrame): boolean {
    const [by, move, zoom] = [WALK[key], MOVE_KEYS[key], ZOOM_KEYS[key]];
    const robot = this.#layers.find(({ isRobot }) => isRobot);
    const here: TimedPose = robot ? { ...robot.state, time: now.time } : now;
    if (key === "Escape") {
      if (this.#isMeasuring) this.onMeasure();
      this.#picked = null;
    } else if (key === "Enter" && this.#picked) this.#pick(this.#picked);
    else if (zoom) this.onZoom(zoom);
    else if (key === "0") this.onFit();
    else if (key === "f") this.onFollow();
    else if (key === "m") this.onMeasure();
    else if (key === "l" && this.#hasLayers) this.onLayers();
    else if (shiftKey && move) this.#onMove(...move);
    else if (by !== undefined) {
      const [{ points } = { points: [] }] = this.#ways;
      const times = points.map(({ time }) => time);
      const at = times.findIndex((time) => time >= (this.#picked?.time ?? now.time));
      this.#picked = points[Math.min(times.length - 1, Math.max(0, at + by))] ?? null;
      if (this.#picked) this.#card.say(toSentence(describePoint(this.#picked, here)));
    } else return false;
    return true;
  }
}

const NOWHERE: TimedPose = { x: NaN, y: NaN, yaw: NaN, time: NaN };
/** Kinds of layers from top to bottom. */
const ORDER: LayerAbout["kind"][] = ["scan", "cone", "pose", "poses", "path", "goal", "grid"];

/** "1.05 m · 12.3°" */
function measureWords(from: Place, to: Place): string {
  const [dx, dy] = [to.x - from.x, to.y - from.y];
  return `${toMetres(Math.hypot(dx, dy))} \u00B7 ${toDegrees(Math.atan2(dy, dx))}`;
}
