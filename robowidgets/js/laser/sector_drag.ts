import type { Point } from "../shared/box.ts";
import { angleOf, indexAt, type Scan } from "../shared/frames/scan.ts";
import type { Drag, Stage } from "./layer.ts";
import { fromPixel } from "./projection.ts";
import { type Edge, type Named, raysAt, type SectorStore, sectorTo, withEdge } from "./sector_store.ts";

/** Drags of sectors along the arc. */
export class SectorDrags {
  readonly #store: SectorStore;
  readonly #stage: () => Stage;
  readonly #end: (undo: () => void) => void;

  /**
   * @param stage the picture as it was drawn last
   * @param end called with what puts back what was, when a drag has ended
   */
  constructor(store: SectorStore, stage: () => Stage, end: (undo: () => void) => void) {
    this.#store = store;
    this.#stage = stage;
    this.#end = end;
  }

  angleAt(point: Point): number {
    return fromPixel(this.#stage().projection, point).angle;
  }

  /** A new sector from the ray under the pointer on. */
  ofNew(scan: Scan, point: Point): Drag {
    const angle = this.angleAt(point);
    const found = indexAt(scan, angle);
    const last = angleOf(scan, scan.count - 1);
    const isFirst = Math.cos(angle - scan.angleMin) > Math.cos(angle - last);
    const from = found >= 0 ? found : isFirst ? 0 : scan.count - 1;
    return this.#drag(scan, angle, (rays) => ({ name: "", sector: sectorTo(scan, from, from + rays) }));
  }

  /** An edge of a sector; null where the sector has no rays. */
  ofEdge(scan: Scan, named: Named, edge: Edge, point: Point): Drag | null {
    const at = raysAt(scan, named.sector, edge);
    if (!at) return null;
    return this.#drag(scan, this.angleAt(point), (rays) => ({
      ...named,
      sector: withEdge(scan, named.sector, edge, at.fixed, at.moved + rays),
    }));
  }

  /** The pointer may go round more than once. */
  #drag(scan: Scan, from: number, toNamed: (rays: number) => Named): Drag {
    const undo = this.#store.snapshot();
    let [last, turned] = [from, 0];
    return {
      move: (point) => {
        const angle = this.angleAt(point);
        turned += Math.atan2(Math.sin(angle - last), Math.cos(angle - last));
        last = angle;
        this.#store.put(toNamed(Math.round(turned / scan.angleIncrement)));
      },
      end: () => this.#end(undo),
      cancel: undo,
    };
  }
}
