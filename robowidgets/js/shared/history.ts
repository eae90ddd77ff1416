import type { About, Moment } from "./traits.ts";

/** Samples kept per second of history; a faster source fills the history in less time. */
const PER_SECOND = 20;
const MOST_BYTES = 8e6;

/**
 * The last samples, oldest first: a number of seconds of them, at most 20 per second and 8 MB.
 *
 * While frozen, it drops no sample that the user may be stepping through, and has the same capacity again for new ones.
 * If that is full too, each new sample replaces the previous one.
 */
export class History {
  readonly moments: Moment[] = [];
  /** True once samples before the first one were dropped. */
  hasDropped = false;
  /** Number of samples when it was frozen, and the time. */
  #frozen: { count: number; at: number } | null = null;

  add(bytes: DataView, at: number, seconds: number, about: About = {}): void {
    const { moments } = this;
    const moment: Moment = { bytes, at, about };
    moments.push(moment);
    if (!this.#frozen) this.#trim(seconds);
    else if (moments.length > this.#frozen.count + 1 && this.#isFull(seconds, this.#frozen.count, this.#frozen.at)) {
      moments.splice(-2, 1);
      moment.isAfterGap = true;
    }
  }

  freeze(at: number): void {
    this.#frozen = { count: this.moments.length, at };
  }

  release(seconds: number): void {
    this.#frozen = null;
    this.#trim(seconds);
  }

  #trim(seconds: number): void {
    const { moments } = this;
    while (moments.length > 1 && this.#isFull(seconds, 0, moments[0]?.at ?? NaN)) {
      moments.shift();
      this.hasDropped = true;
    }
  }

  /** Returns true if the samples from an index on exceed the capacity, counted since a time. */
  #isFull(seconds: number, from: number, since: number): boolean {
    const later = this.moments.slice(from);
    const size = later.reduce((sum, { bytes }) => sum + bytes.byteLength, 0);
    const passed = (later.at(-1)?.at ?? NaN) - since;
    return later.length > PER_SECOND * seconds || size > MOST_BYTES || !(passed <= 1000 * seconds);
  }
}
