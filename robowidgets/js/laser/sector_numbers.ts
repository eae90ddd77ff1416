import type { Scan } from "../shared/frames/scan.ts";
import { type Measured, measure, type Sector, type State, type Stretch, stateOf, stretchesOf } from "./sector.ts";
import type { Named } from "./sector_store.ts";

/** Sectors of one scan whose numbers are kept: a drag over a frozen scan makes many. */
const MOST = 50;

/** The rays of a sector, and their measurements. */
interface Looked {
  stretches: Stretch[];
  measured: Measured;
}

/** The measurements of the sectors of a view, computed once for each scan. */
export class SectorNumbers {
  #scan: Scan | null = null;
  #looked = new Map<string, Looked>();
  #judged: Scan | null = null;
  #states = new Map<string, State>();
  /** The states at the previous scan. */
  #before = this.#states;

  look(scan: Scan, { start, end }: Sector): Looked {
    if (this.#scan !== scan || this.#looked.size > MOST) this.#looked.clear();
    this.#scan = scan;
    const key = `${start} ${end}`;
    const known = this.#looked.get(key);
    if (known) return known;
    const stretches = stretchesOf(scan, { start, end });
    const found = { stretches, measured: measure(scan, stretches) };
    this.#looked.set(key, found);
    return found;
  }

  /** Updates the states of the limits. A frozen scan is judged by itself, without the previous scan. */
  judge(all: Named[], scan: Scan | null, isFrozen: boolean): void {
    if (!scan) return;
    if (scan !== this.#judged) this.#before = this.#states;
    this.#judged = scan;
    const judge = ({ name, sector }: Named): [string, State] => {
      const before = isFrozen ? "free" : (this.#before.get(name) ?? "free");
      return [name, stateOf(sector, this.look(scan, sector).measured.distance, before)];
    };
    this.#states = new Map(all.map(judge));
  }

  stateOf(name: string): State {
    return this.#states.get(name) ?? "";
  }
}
