import { onAbort } from "../shared/events.ts";
import type { Segments } from "./segments.ts";

/** Milliseconds without an event after which the pointer rests. */
const REST_MS = 30;
/** Milliseconds after which a request may be repeated; until then the kernel may be busy with it. */
const LOST_MS = 1000;

/** Fetches the segment under the pointer, so that it is in the page by the time of the click. Newest wins. */
export class Prefetcher {
  readonly #segments: Segments;
  readonly #send: (time: number) => void;
  #pointed: number | undefined;
  #timer: ReturnType<typeof setTimeout> | undefined;
  /** The pending request, and the one to send after it. */
  #asked: number | null = null;
  #next: number | null = null;
  #askedAt = 0;

  constructor(segments: Segments, send: (time: number) => void, signal: AbortSignal) {
    this.#segments = segments;
    this.#send = send;
    onAbort(signal, () => clearTimeout(this.#timer));
  }

  /** Notes the time under the pointer, or null after it has left. */
  point(time: number | null): void {
    const index = time === null ? undefined : this.#segments.indexOf(time);
    if (index === this.#pointed) return;
    this.#pointed = index;
    this.#next = null;
    clearTimeout(this.#timer);
    if (time !== null) this.#timer = setTimeout(() => this.ask(time), REST_MS);
  }

  /** Requests the segment of a time, unless the page has it; waits for a pending request first. */
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

  /** Notes that a segment has arrived. */
  came(): void {
    if (this.#asked === null || !this.#segments.has(this.#asked)) return;
    this.#asked = null;
    if (this.#next !== null) this.ask(this.#next);
  }
}
