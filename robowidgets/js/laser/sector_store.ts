import { isFullCircle, type Sweep } from "../shared/frames/scan.ts";
import type { Model } from "../shared/model.ts";
import { throttle } from "../shared/schedule.ts";
import { keepChange } from "../shared/undo.ts";
import { type Sector, sectorOf, stretchesOf } from "./sector.ts";
import type { LaserTraits } from "./traits.ts";

const SAVE_MS = 100;

/** A sector with its name; "" for one that is not kept. */
export interface Named {
  name: string;
  sector: Sector;
}

export type Edge = "start" | "end";

/** The kept and the picked sectors at one time. */
export interface Sectors {
  kept: Record<string, Sector>;
  selection: LaserTraits["_selection"];
}

/** The kept and the picked sectors, in the traits. While the user drags, Python gets ten changes a second. */
export class SectorStore {
  readonly #model: Model<LaserTraits>;
  readonly #card: Element;
  readonly #save: () => void;

  constructor(model: Model<LaserTraits>, card: Element, signal: AbortSignal) {
    this.#model = model;
    this.#card = card;
    this.#save = throttle(() => model.save_changes(), SAVE_MS, signal);
  }

  get kept(): Record<string, Sector> {
    return this.#model.get("_sectors");
  }

  get picked(): Named | null {
    const { name, start, end, ...limits } = this.#model.get("_selection");
    if (name !== undefined) {
      const sector = Object.hasOwn(this.kept, name) ? this.kept[name] : undefined;
      return sector ? { name, sector } : null;
    }
    return start === undefined || end === undefined ? null : { name: "", sector: { start, end, ...limits } };
  }

  /** All sectors, the picked one last. */
  get all(): Named[] {
    const { picked } = this;
    const others = Object.entries(this.kept).filter(([name]) => name !== picked?.name);
    return [...others.map(([name, sector]) => ({ name, sector })), ...(picked ? [picked] : [])];
  }

  pick(name: string | null): void {
    this.#put(this.kept, name === null ? {} : { name });
  }

  /** Selects other rays for the sector of this name; with the name "", as a sector that is not kept. */
  put({ name, sector }: Named): void {
    if (name) this.#put({ ...this.kept, [name]: sector }, { name });
    else this.#put(this.kept, { ...sector });
  }

  /** Keeps the picked sector under a name, or renames it; returns an error text, or "". */
  keep(name: string): string {
    const { picked } = this;
    if (!picked) return "";
    if (name !== picked.name && Object.hasOwn(this.kept, name)) return `there is a sector ${name} already`;
    const { now } = this;
    const others = Object.entries(this.kept).filter(([other]) => other !== picked.name);
    this.#put({ ...Object.fromEntries(others), [name]: picked.sector }, { name });
    this.keepUndo(now);
    return "";
  }

  remove(): void {
    const { now, picked } = this;
    this.#put(Object.fromEntries(Object.entries(this.kept).filter(([name]) => name !== picked?.name)), {});
    this.keepUndo(now);
  }

  get now(): Sectors {
    return { kept: this.kept, selection: this.#model.get("_selection") };
  }

  /**
   * Restores the sectors that were picked at two times. A sector that Python, or another view, has set since stays as
   * it is.
   */
  restore({ kept, selection }: Sectors, after = this.now): void {
    const all = { ...this.kept };
    for (const name of namesIn({ kept, selection }, after)) {
      const [old, changed] = [kept[name], after.kept[name]];
      if (isSame(old, changed) || !isSame(all[name], changed)) continue;
      if (old) all[name] = old;
      else delete all[name];
    }
    this.#put(all, selection);
    // The view whose change it was may have ended.
    this.#model.save_changes();
  }

  /** Keeps the change since a time for Ctrl+Z, if there is one. */
  keepUndo(before: Sectors): void {
    const { now: after } = this;
    const names = namesIn(before, after);
    // Without the choice among the kept ones.
    const [old, changed] = [before, after].map(({ kept, selection }) => [
      names.map((name) => kept[name]),
      selection.name === undefined ? selection : {},
    ]);
    if (isSame(old, changed)) return;
    const name = names.at(-1);
    keepChange(this.#card, { words: name ? `sector “${name}”` : "sector", undo: () => this.restore(before, after) });
  }

  #put(kept: Record<string, Sector>, selection: LaserTraits["_selection"]): void {
    if (kept !== this.kept) this.#model.set("_sectors", kept);
    this.#model.set("_selection", selection);
    this.#save();
  }
}

/** The names of the sectors that were picked at two times. */
function namesIn(...times: Sectors[]): string[] {
  return times.flatMap(({ selection: { name } }) => (name === undefined ? [] : [name]));
}

function isSame(a: unknown, b: unknown): boolean {
  return JSON.stringify(a) === JSON.stringify(b);
}

/** The first and the last ray of a sector as the scanner passes through it; null without any. */
function endsOf(sweep: Sweep, sector: Sector): { first: number; last: number } | null {
  const stretches = stretchesOf(sweep, sector);
  const [first] = stretches[0] ?? [];
  if (first === undefined) return null;
  return { first, last: first + stretches.reduce((sum, [start, stop]) => sum + stop - start, 0) - 1 };
}

/** Index of the ray at an edge of a sector, and at the other edge; null for a sector without rays. */
export function raysAt(sweep: Sweep, sector: Sector, edge: Edge): { moved: number; fixed: number } | null {
  const ends = endsOf(sweep, sector);
  if (!ends) return null;
  const isFirst = (edge === "start") === sweep.angleIncrement > 0;
  return isFirst ? { moved: ends.first, fixed: ends.last } : { moved: ends.last, fixed: ends.first };
}

/** The sector from one ray to another, at most all rays; the second may lie beyond the array. */
export function sectorTo(sweep: Sweep, from: number, to: number): Sector {
  const last = sweep.count - 1;
  const [least, most] = isFullCircle(sweep) ? [from - last, from + last] : [0, last];
  return sectorOf(sweep, from, Math.min(most, Math.max(least, to)));
}

/** A sector with one edge moved to a ray. The other edge keeps its angle, unless the first is moved past it. */
export function withEdge(sweep: Sweep, sector: Sector, edge: Edge, fixed: number, to: number): Sector {
  const next = { ...sector, ...sectorTo(sweep, fixed, to) };
  const isPast = edge === "end" ? (to - fixed) * sweep.angleIncrement < 0 : (to - fixed) * sweep.angleIncrement > 0;
  const other = edge === "start" ? "end" : "start";
  return isPast ? next : { ...next, [other]: sector[other] };
}
