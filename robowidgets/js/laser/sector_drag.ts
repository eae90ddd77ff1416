import type { Point } from "../shared/box.ts";
import { angleOf, indexAt, type Scan } from "../shared/frames/scan.ts";
import { fromPixel } from "../shared/projection.ts";
import type { Drag, Stage } from "./layer.ts";
import { type Edge, type Named, raysAt, type SectorStore, type Sectors, sectorTo, withEdge } from "./sector_store.ts";

/** Drags of sectors along the arc. */
export class SectorDrags {
  /** All sectors before the drag, while there is one. */
  before: Named[] | null = null;
  readonly #store: SectorStore;
  readonly #stage: () => Stage;
  readonly #end: (before: Sectors) => void;

  /**
   * @param stage the picture as it was drawn last
   * @param end called after a drag, with the sectors before it
   */
  constructor(store: SectorStore, stage: () => Stage, end: (before: Sectors) => void) {
    this.#store = store;
    this.#stage = stage;
    this.#end = end;
  }

  angleAt(point: Point): number {
    return fromPixel(this.#stage().projection, point).angle;
  }

  /** Starts a new sector at the ray under the pointer. */
  ofNew(scan: Scan, point: Point): Drag {
    const angle = this.angleAt(point);
    const found = indexAt(scan, angle);
    const last = angleOf(scan, scan.count - 1);
    const isFirst = Math.cos(angle - scan.angleMin) > Math.cos(angle - last);
    const from = found >= 0 ? found : isFirst ? 0 : scan.count - 1;
    return this.#drag(scan, angle, (rays) => ({ name: "", sector: sectorTo(scan, from, from + rays) }));
  }

  /** Drags an edge of a sector; null for a sector without rays. */
  ofEdge(scan: Scan, named: Named, edge: Edge, point: Point): Drag | null {
    const at = raysAt(scan, named.sector, edge);
    if (!at) return null;
    const toNamed = (rays: number) => ({
      ...named,
      sector: withEdge(scan, named.sector, edge, at.fixed, at.moved + rays),
    });
    // The edge may stand far beyond the last ray.
    return this.#drag(scan, this.angleAt(point), toNamed, wrap(named.sector[edge] - angleOf(scan, at.moved)));
  }

  /**
   * The pointer may go round more than once.
   *
   * @param beyond radians from the ray that moves to the edge under the pointer
   */
  #drag(scan: Scan, from: number, toNamed: (rays: number) => Named, beyond = 0): Drag {
    const { now } = this.#store;
    this.before = this.#store.all;
    let [last, turned] = [from, beyond];
    return {
      move: (point) => {
        const angle = this.angleAt(point);
        turned += wrap(angle - last);
        last = angle;
        this.#store.put(toNamed(Math.round(turned / scan.angleIncrement)));
      },
      end: () => {
        this.before = null;
        this.#end(now);
      },
      cancel: () => {
        this.before = null;
        this.#store.restore(now);
      },
    };
  }
}

/** The same turn, within half a turn. */
function wrap(angle: number): number {
  return Math.atan2(Math.sin(angle), Math.cos(angle));
}
