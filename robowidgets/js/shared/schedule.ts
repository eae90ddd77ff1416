import { onAbort } from "./events.ts";

/** Between two updates of text. People read no faster, and laying out text is slower than drawing dots. */
const READING_MS = 100;
/** From the first change of a text until it is written without a drawing. */
const LATE_MS = 1.5 * READING_MS;

/** Draws at most once per animation frame. */
export function perAnimationFrame(draw: () => void, signal: AbortSignal): () => void {
  let pending = 0;
  onAbort(signal, () => cancelAnimationFrame(pending));
  return () => {
    if (pending || signal.aborted) return;
    pending = requestAnimationFrame(() => {
      pending = 0;
      draw();
    });
  };
}

/** Calls at once, then at most once per `ms`; calls in between are merged into one at the end of the interval. */
export function throttle(call: () => void, ms: number, signal: AbortSignal): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  let asked = false;
  onAbort(signal, () => clearTimeout(timer));
  const run = () => {
    asked = false;
    timer = setTimeout(() => {
      timer = undefined;
      if (asked) run();
    }, ms);
    call();
  };
  return () => {
    asked = true;
    if (timer === undefined && !signal.aborted) run();
  };
}

/** The texts beside a picture. They are written after it is painted, in the same frame. */
export class Texts {
  readonly #waiting = new Set<() => void>();
  #timer: ReturnType<typeof setTimeout> | undefined;
  #next = 0;

  constructor(signal: AbortSignal) {
    onAbort(signal, () => {
      clearTimeout(this.#timer);
      this.#waiting.clear();
    });
  }

  /** Has a text written after the drawing that is under way, or, no oftener than people read, after one of the next. */
  ask(write: () => void): void {
    this.#waiting.add(write);
    this.#timer ??= setTimeout(() => this.write(true), LATE_MS);
  }

  /** Writes what was asked for, if it is time. @param isNow whether it is in any case */
  write(isNow: boolean): void {
    const now = performance.now();
    if (!isNow && now < this.#next) return;
    this.#next = now + READING_MS;
    clearTimeout(this.#timer);
    this.#timer = undefined;
    const writes = [...this.#waiting];
    this.#waiting.clear();
    for (const write of writes) write();
  }
}
