import { onAbort } from "../shared/events.ts";
import type { Segments } from "./segments.ts";

/** Milliseconds after which a pointer rests: while it moves, events come twice as often. */
const REST_MS = 30;
/** Milliseconds after which an answer may have been lost; a busy kernel is asked no more often. */
const LOST_MS = 1000;

/** Asks Python for what a person points at and the page does not have: by the click it is here. Newest wins. */
export class Prefetcher {
  readonly #segments: Segments;
  readonly #send: (time: number) => void;
  #pointed: number | undefined;
  #timer: ReturnType<typeof setTimeout> | undefined;
  /** What was asked for and is not here yet, and what is asked for then. */
  #asked: number | null = null;
  #next: number | null = null;
  #askedAt = 0;

  constructor(segments: Segments, send: (time: number) => void, signal: AbortSignal) {
    this.#segments = segments;
    this.#send = send;
    onAbort(signal, () => clearTimeout(this.#timer));
  }

  /** A person points at a time; null: at none. */
  point(time: number | null): void {
    const index = time === null ? undefined : this.#segments.indexOf(time);
    if (index === this.#pointed) return;
    this.#pointed = index;
    this.#next = null;
    clearTimeout(this.#timer);
    if (time !== null) this.#timer = setTimeout(() => this.ask(time), REST_MS);
  }

  /** Asks for what is at a time, unless it is here; after what is on its way. */
  ask(time: number): void {
    this.#next = null;
    if (this.#segments.has(time)) return;
    if (this.#asked !== null && performance.now() - this.#askedAt < LOST_MS) {
      this.#next = time;
      return;
    }
    this.#asked = time;
    this.#askedAt = performance.now();
    this.#send(time);
  }

  /** A segment has come. */
  came(): void {
    if (this.#asked === null || !this.#segments.has(this.#asked)) return;
    this.#asked = null;
    if (this.#next !== null) this.ask(this.#next);
  }
}
