import type { About } from "./traits.ts";

/** A sample that came, when, in the page's milliseconds (NaN when the page found it at its load), and what was said of it. */
export interface Moment {
  bytes: DataView;
  at: number;
  about: About;
}

/** Samples kept for each second that is; what comes faster fills the room sooner. */
const PER_SECOND = 20;
const MOST_BYTES = 8e6;

/**
 * The samples that came last, oldest first: so many seconds of them, 20 a second and 8 MB at most.
 *
 * Held, it lets nothing go that a person may be stepping through, and has as much room again for what comes next. Once
 * that is full, the newest sample takes the place of the one before it.
 */
export class History {
  readonly moments: Moment[] = [];
  /** How many there were when it was held, and when that was. */
  #held: { count: number; at: number } | null = null;

  add(bytes: DataView, at: number, seconds: number, about: About = {}): void {
    const { moments } = this;
    moments.push({ bytes, at, about });
    if (!this.#held) this.#trim(seconds);
    else if (moments.length > this.#held.count + 1 && this.#isFull(seconds, this.#held.count, this.#held.at)) {
      moments.splice(-2, 1);
    }
  }

  hold(at: number): void {
    this.#held = { count: this.moments.length, at };
  }

  release(seconds: number): void {
    this.#held = null;
    this.#trim(seconds);
  }

  #trim(seconds: number): void {
    const { moments } = this;
    while (moments.length > 1 && this.#isFull(seconds, 0, moments[0]?.at ?? NaN)) moments.shift();
  }

  /** Whether from an index on, and since a time, there is more than there is room for. */
  #isFull(seconds: number, from: number, since: number): boolean {
    const later = this.moments.slice(from);
    const size = later.reduce((sum, { bytes }) => sum + bytes.byteLength, 0);
    const passed = (later.at(-1)?.at ?? NaN) - since;
    return later.length > PER_SECOND * seconds || size > MOST_BYTES || !(passed <= 1000 * seconds);
  }
}
