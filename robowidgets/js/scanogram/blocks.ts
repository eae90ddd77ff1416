import { READING } from "../shared/frames/scan.ts";
import { firstWhere } from "../shared/search.ts";
import type { Span } from "../shared/time_axis.ts";
import { type Block, type Detail, kindOf, NO_SCAN, type Speeds, toRange, type Whole } from "./data.ts";

/** Bytes of details that a page keeps, without the whole. */
const KEPT_BYTES = 48_000_000;

/** One ray at one time, in the finest detail that the page has. */
export interface Place {
  index: number;
  /** Number of scans and of rays that share this value. */
  scans: number;
  rays: number;
  /**
   * Number of the first of these scans, null if the picture has only some scans of the drive; its time in seconds; when
   * the last one ends.
   */
  scan: number | null;
  time: number;
  end: number;
  code: number;
  /** Metres; NaN for codes that stand for no distance. */
  range: number;
  /** True if the range is the measured number, not one decoded from a code. */
  exact: boolean;
}

/** The scans in the page: all of them in coarse detail, and parts in fine detail. */
export class Blocks {
  readonly #whole: Whole;
  #details: Detail[] = [];

  constructor(whole: Whole) {
    this.#whole = whole;
  }

  add(detail: Detail): void {
    if (detail.edition !== this.#whole.edition) return;
    this.#details = [detail, ...this.#details.filter((old) => !isWithin(old, detail))];
    let bytes = 0;
    this.#details = this.#details.filter(({ block }) => {
      bytes += 16 * block.startsAt.length + 2 * block.codes.length + 4 * block.ranges.length;
      return bytes <= KEPT_BYTES;
    });
  }

  /** All blocks, the finest first, the whole last. */
  get all(): Block[] {
    const details = this.#details.map(({ block }) => block).filter(({ startsAt }) => startsAt.length > 0);
    return [...details.sort((a, b) => a.size - b.size || b.ranges.length - a.ranges.length), this.#whole.block];
  }

  /** The finest block that covers a span. */
  over(span: Span): Block {
    return this.all.find((block) => covers(block, span)) ?? this.#whole.block;
  }

  /** Returns true if Python has finer detail of a span shown in some number of columns. */
  wants(span: Span, columns: number): boolean {
    const block = this.over(span);
    if (block.size === 1 && block.ranges.length) return false;
    const seen =
      firstWhere(block.startsAt, (start) => start >= span[1]) - firstWhere(block.endsAt, (end) => end > span[0]);
    const [begin, end] = this.#whole.span;
    const isWhole = span[1] - span[0] >= (end - begin) * 0.999;
    return block.size === 1 ? !isWhole : seen < columns;
  }

  /** The speeds in a span, in the finest detail that the page has. */
  speedsIn(span: Span): Speeds | null {
    const fine = this.#details.find(
      (detail) => detail.speeds && detail.span[0] <= span[0] && detail.span[1] >= span[1],
    );
    return fine?.speeds ?? this.#whole.speed?.speeds ?? null;
  }

  /** The ray of an index at a time; null without a scan. */
  at(time: number, index: number): Place | null {
    const { sweep } = this.#whole;
    for (const block of this.all) {
      const cell = cellAt(block, time);
      if (cell < 0) continue;
      const ray = Math.floor(index / block.rayStep);
      const code = block.codes[cell * block.rays + ray] ?? NO_SCAN;
      if (code === NO_SCAN) continue;
      const exact = block.ranges.length > 0;
      const scan = block.first + cell * block.size;
      return {
        index: ray * block.rayStep,
        scans: Math.min(block.size, this.#whole.scanCount - scan),
        rays: Math.min(block.rayStep, sweep.count - ray * block.rayStep),
        scan: this.#whole.driveScans === undefined ? scan : null,
        time: block.startsAt[cell] as number,
        end: block.endsAt[cell] as number,
        code,
        range: exact
          ? (block.ranges[cell * block.rays + ray] as number)
          : kindOf(code) === READING
            ? toRange(code, sweep)
            : NaN,
        exact,
      };
    }
    return null;
  }

  /**
   * The ray of an index in the scan nearest to a time, not farther away than a tolerance. In a picture of parts a scan is
   * narrower than the pixel that shows it, so the pointer is never exactly on it.
   */
  near(time: number, index: number, tolerance: number): Place | null {
    const { startsAt, endsAt } = this.#whole.block;
    const next = firstWhere(startsAt, (start) => start > time);
    const after = startsAt[next] ?? Infinity;
    const before = startsAt[next - 1] ?? -Infinity;
    const since = time - (endsAt[next - 1] ?? -Infinity);
    if (Math.min(since, after - time) > tolerance) return null;
    return this.at(since <= after - time ? before : after, index);
  }

  /** The start of the scan a number of steps from a time, if the page has single scans there. */
  step(time: number, by: number): number {
    for (const block of this.all) {
      const { startsAt } = block;
      const at = firstWhere(startsAt, (start) => start > time + by / 1e9) + by - (by > 0 ? 1 : 0);
      const next = startsAt[Math.min(startsAt.length - 1, Math.max(0, at))] ?? time;
      // At the end of a fine block, a coarser one continues.
      if (covers(block, [time, time]) && by * (next - time) > 0) return next;
    }
    return time;
  }

  /** The number of scans that start in a span, and true if that is exact. */
  count([start, end]: Span): { scans: number; exact: boolean } {
    const block = this.over([start, end]);
    const [first, stop] = [start, end].map((time) => firstWhere(block.startsAt, (other) => other >= time - 1e-9));
    const scans = Math.min(this.#whole.scanCount, ((stop ?? 0) - (first ?? 0)) * block.size);
    return { scans, exact: block.size === 1 };
  }
}

/** The number of the cell at a time; -1 without one. */
export function cellAt({ startsAt, endsAt }: Block, time: number): number {
  const cell = firstWhere(startsAt, (start) => start > time) - 1;
  return cell >= 0 && ((endsAt[cell] as number) > time || startsAt[cell] === time) ? cell : -1;
}

export function covers({ startsAt, endsAt }: Block, [start, end]: Span): boolean {
  return startsAt.length > 0 && (startsAt[0] as number) <= start && (endsAt.at(-1) as number) >= end;
}

function isWithin({ block }: Detail, { block: other }: Detail): boolean {
  if (!block.startsAt.length || block.size < other.size) return !block.startsAt.length;
  if (block.size === other.size && block.ranges.length && !other.ranges.length) return false;
  return covers(other, [block.startsAt[0] as number, block.endsAt.at(-1) as number]);
}
