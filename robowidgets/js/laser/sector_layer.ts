import { type Box, holds, type Point } from "../shared/box.ts";
import { make } from "../shared/dom.ts";
import { angleOf, indexAt, READING, type Sweep } from "../shared/frames/scan.ts";
import { arcRim, type Rim, toPixel } from "../shared/projection.ts";
import type { Theme } from "../shared/theme.ts";
import { leadTo } from "./chip_place.ts";
import {
  drawEdges,
  drawHandles,
  drawLimits,
  drawName,
  fillWedge,
  type NamePlace,
  PICKED_OPACITY,
  pointAt,
  rimOf,
  SECTOR_OPACITY,
} from "./draw_sector.ts";
import type { Depth, Drag, Host, Layer, Painter, Stage, Stops, StripPainter } from "./layer.ts";
import { isIn, sweepOf } from "./sector.ts";
import { SectorChip } from "./sector_chip.ts";
import { SectorDrags } from "./sector_drag.ts";
import { onSectorKey } from "./sector_keys.ts";
import { SectorNumbers } from "./sector_numbers.ts";
import { type Edge, type Named, raysAt, SectorStore, type Sectors, sectorTo, withEdge } from "./sector_store.ts";
import { toLines } from "./sector_words.ts";
import { sectorStrip } from "./strip_sector.ts";

/** Pixels in which a drag by touch starts at the rim, and within which a mouse takes a rim or a handle. */
const TOUCH_RIM = 28;
const RIM = 8;
const GRAB = { mouse: 12, touch: 22 };
const ROBOT = 20;

/** Sectors: the kept ones with their names, and the sector that the user drags, names or copies as code. */
export class SectorLayer implements Layer {
  readonly traits = ["_sectors", "_selection"] as const;
  readonly store: SectorStore;
  /** The hint in the footer until the first drag. */
  readonly hint = make("span", "rw-drag-hint");
  readonly #host: Host;
  readonly #numbers = new SectorNumbers();
  readonly #drags: SectorDrags;
  readonly #chip: SectorChip;
  #edge: Edge | null = null;
  /** The sectors before the change of an edge. */
  #before: Sectors | null = null;
  #names = new Map<string, NamePlace>();

  constructor(host: Host) {
    this.#host = host;
    this.store = new SectorStore(host.model, host.card.picture, host.signal);
    this.hint.append(make("span", "", "drag along an arc to select rays"));
    const onDragged = (before: Sectors) => {
      this.hint.remove();
      this.store.keepUndo(before);
      this.#chip.close();
      this.#leaveEdge();
      this.say();
    };
    this.#drags = new SectorDrags(this.store, () => host.stage, onDragged);
    this.#chip = new SectorChip(host, this.store, this.#numbers, this);
  }

  painters(): Partial<Record<Depth, Painter>> {
    const { all } = this.store;
    if (!all.length) return {};
    const { picked } = this.store;
    const isPicked = ({ name }: Named) => picked?.name === name;
    return {
      fills: (context, stage, theme) => {
        for (const one of all) {
          const [color, opacity] = isPicked(one) ? [theme.pointer, PICKED_OPACITY] : [theme.ink, SECTOR_OPACITY];
          fillWedge(context, stage.projection, one.sector, rimOf(stage), color, opacity);
        }
      },
      edges: (context, stage, theme) => {
        this.#numbers.judge(all, stage.scan, this.#host.stream.paused);
        for (const one of all) drawEdges(context, stage, one.sector, isPicked(one), theme);
        for (const { sector } of all) {
          for (const angle of [sector.start, sector.end]) {
            const { x, y } = pointAt(stage.projection, rimOf(stage), angle);
            stage.occupied.mark(x, y);
            stage.edges.push(angle);
          }
        }
      },
      conditions: (context, stage, theme) => {
        for (const one of all) {
          drawLimits(context, stage, one.sector, this.#numbers.stateOf(one.name), isPicked(one), theme);
        }
      },
      rings: (context, stage, theme) => this.#drawRing(context, stage, theme),
      names: (context, stage, theme) => this.#drawNames(context, stage, all, theme),
      handles: (context, stage, theme) => {
        for (const one of all) {
          drawHandles(context, stage, one.sector, isPicked(one), isPicked(one) ? this.#edge : null, theme);
        }
        if (picked && this.#chip.box) leadTo(context, stage, picked.sector, this.#chip.box, theme);
      },
    };
  }

  strip(): Partial<Record<Depth, StripPainter>> {
    return sectorStrip(this.store.all, this.store.picked, this.#numbers);
  }

  lowerKey(): unknown {
    const { all, picked } = this.store;
    const isDragged = this.#drags.before !== null;
    return all.length ? [all.map(({ sector: { start, end } }) => [start, end]), picked !== null, isDragged] : null;
  }

  /**
   * All of each sector, also outside the rays of the scanner: else its handles may be out of the picture. It does not
   * change during a drag.
   */
  rim(_: Sweep, forward: number): Rim[] {
    const all = this.#drags.before ?? this.store.all;
    return all.flatMap(({ sector }) => arcRim(sector.start, sector.start + sweepOf(sector), forward));
  }

  covers(): Box[] {
    return this.#chip.box ? [this.#chip.box] : [];
  }

  place(stage: Stage): void {
    this.#chip.place(stage);
  }

  onHover(point: Point | null): boolean {
    const { picture } = this.#host.card;
    const handle = point && this.#handleAt(point, GRAB.mouse);
    const isName = point && this.#nameAt(point);
    const isArc = point && this.#host.stage.scan && this.#isInside(point);
    picture.style.cursor = handle ? "grab" : isName ? "pointer" : isArc ? "crosshair" : "";
    return Boolean(handle);
  }

  onClick(point: Point): boolean {
    const handle = this.#handleAt(point, GRAB.mouse);
    const name = handle ? handle.named.name : this.#nameAt(point);
    if (!name) return handle !== null;
    this.#leaveEdge();
    this.store.pick(this.store.picked?.name === name ? null : name);
    this.say();
    return true;
  }

  onPress(point: Point, isTouch: boolean): Drag | null {
    const { scan } = this.#host.stage;
    if (!scan || scan.count < 2) return null;
    const handle = this.#handleAt(point, isTouch ? GRAB.touch : GRAB.mouse);
    if (handle) return this.#drags.ofEdge(scan, handle.named, handle.edge, point);
    return this.#isInside(point, isTouch) ? this.#drags.ofNew(scan, point) : null;
  }

  /** Returns true if a drag from a point makes a sector. */
  #isInside(point: Point, isTouch = false): boolean {
    const { stage } = this.#host;
    const pixels = Math.hypot(point.x - stage.projection.centerX, point.y - stage.projection.centerY);
    const rim = rimOf(stage);
    return isTouch ? Math.abs(pixels - rim) <= TOUCH_RIM : pixels >= ROBOT && pixels <= rim + RIM;
  }

  onKey(event: KeyboardEvent): boolean {
    return onSectorKey(event, this);
  }

  /** The kept sectors. */
  get stops(): Stops {
    const { kept, picked } = this.store;
    const pick = (name: string) => {
      this.#leaveEdge();
      this.store.pick(name || null);
      if (name) this.say();
    };
    return { names: Object.keys(kept), picked: picked?.name ?? "", pick };
  }

  // Actions of keys, gestures and the chip

  get edge(): Edge | null {
    return this.#edge;
  }

  /** Chooses an edge for the arrow keys; makes a sector if there is not a picked one. */
  chooseEdge(edge: Edge): void {
    const scan = this.#host.stream.shown;
    if (!scan || scan.count < 2) return;
    if (!this.store.picked) {
      const { now } = this.store;
      this.#before = now;
      const pinned = this.#host.model.get("pinned");
      const middle = Math.min(scan.count - 1, pinned ?? Math.max(0, indexAt(scan, 0)));
      const few = Math.max(1, Math.round(scan.count / 40));
      this.store.put({ name: "", sector: sectorTo(scan, middle - Math.min(middle, few), middle + few) });
      this.store.keepUndo(now);
    } else if (!this.#edge) this.#before = this.store.now;
    this.#edge = edge;
    this.say();
    this.#host.card.redraw();
  }

  moveEdge(rays: number): void {
    const scan = this.#host.stream.shown;
    const { picked } = this.store;
    const at = scan && picked && this.#edge && raysAt(scan, picked.sector, this.#edge);
    if (!scan || !picked || !at || !this.#edge) return;
    const { now } = this.store;
    this.store.put({ ...picked, sector: withEdge(scan, picked.sector, this.#edge, at.fixed, at.moved + rays) });
    this.store.keepUndo(now);
    this.say();
  }

  /** Ends the change of edges; asks for the name of a sector without one. */
  keep(): void {
    this.#leaveEdge();
    if (!this.store.picked?.name) this.askName();
  }

  /** Asks for the rays of a new sector in a text field. */
  askRays(): void {
    if (this.#host.stream.shown) this.#chip.askRays();
  }

  askName(): void {
    const taken = Object.keys(this.store.kept);
    let number = 1;
    while (taken.includes(`sector ${number}`)) number++;
    this.#chip.askName(this.store.picked?.name || `sector ${number}`);
  }

  /** Undoes the change of an edge, else deselects; returns false without anything to undo. */
  escape(): boolean {
    if (this.#chip.close()) return true;
    if (!this.store.picked) return false;
    if (this.#edge && this.#before) this.store.restore(this.#before);
    else this.store.pick(null);
    this.#leaveEdge();
    this.#host.card.say([]);
    return true;
  }

  deselect(): void {
    // The field for other rays closes first.
    if (!this.#chip.close()) {
      this.#leaveEdge();
      this.store.pick(null);
    }
    this.#host.card.picture.focus({ preventScroll: true });
  }

  remove(): void {
    this.#leaveEdge();
    this.store.remove();
    this.#host.card.say(["removed"]);
    this.#host.card.picture.focus({ preventScroll: true });
  }

  copy(): void {
    this.#chip.copy();
  }

  /** Announces the picked sector to a screen reader. */
  say(): void {
    this.#host.card.say(this.#chip.words);
  }

  #handleAt(point: Point, reach: number): { named: Named; edge: Edge } | null {
    const { stage } = this.#host;
    const rim = rimOf(stage);
    let [found, least]: [{ named: Named; edge: Edge } | null, number] = [null, reach + 1e-9];
    for (const named of this.store.all) {
      for (const edge of ["start", "end"] as const) {
        const { x, y } = pointAt(stage.projection, rim, named.sector[edge]);
        const away = Math.hypot(x - point.x, y - point.y);
        if (away <= least) [found, least] = [{ named, edge }, away];
      }
    }
    return found;
  }

  /** The kept sector whose name or rim is at a point; "" for none. */
  #nameAt(point: Point): string {
    const { stage } = this.#host;
    for (const [name, { box }] of this.#names) if (holds(box, point)) return name;
    const { centerX, centerY } = stage.projection;
    if (Math.abs(Math.hypot(point.x - centerX, point.y - centerY) - rimOf(stage)) > RIM) return "";
    return this.store.all.find(({ sector }) => isIn(sector, this.#drags.angleAt(point)))?.name ?? "";
  }

  #leaveEdge(): void {
    this.#edge = null;
    this.#host.card.redraw();
  }

  /** A ring round the nearest reading of the picked sector. */
  #drawRing(context: CanvasRenderingContext2D, { scan, projection, occupied }: Stage, theme: Theme): void {
    const { picked } = this.store;
    const nearest = picked && scan ? this.#numbers.look(scan, picked.sector).measured.nearest : -1;
    const range = scan?.ranges[nearest] ?? Infinity;
    if (!scan || scan.kinds[nearest] !== READING || range > projection.viewRange) return;
    const { x, y } = toPixel(projection, range, angleOf(scan, nearest));
    context.beginPath();
    context.arc(x, y, 6, 0, 2 * Math.PI);
    context.strokeStyle = theme.pointer;
    context.lineWidth = 2;
    context.stroke();
    occupied.mark(x, y);
  }

  #drawNames(context: CanvasRenderingContext2D, stage: Stage, all: Named[], theme: Theme): void {
    const { scan } = stage;
    const before = this.#names;
    this.#names = new Map();
    const reach = stage.projection.viewRange;
    for (const named of [...all].reverse()) {
      if (!named.name || !scan) continue;
      const isPicked = this.store.picked?.name === named.name;
      const lines = toLines(
        named,
        this.#numbers.look(scan, named.sector).measured,
        this.#numbers.stateOf(named.name),
        reach,
      );
      const color = isPicked ? theme.pointer : theme.ink;
      // The chip has the numbers of the picked sector.
      const shown = isPicked ? lines.slice(0, 1) : lines;
      const place = drawName(context, stage, named.sector, shown, color, theme, before.get(named.name));
      if (!place) continue;
      this.#names.set(named.name, place);
      stage.covered.push(place.box);
    }
  }
}
