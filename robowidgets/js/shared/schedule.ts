import { onAbort } from "./events.ts";
import { isPrinting, onPrint } from "./print.ts";

/** Between two updates of text. Reading is not faster, and laying out text is slower than drawing dots. */
const READING_MS = 100;
/** From the first change of a text until it is written without a drawing. */
const LATE_MS = 1.5 * READING_MS;

/** Of one animation frame, for drawings; the remaining ones wait for the next one. */
const BUDGET_MS = 8;
/** From one frame of a display to the next. */
const FRAME_MS = 1000 / 60;
/** Longest rest of cards: a page may have slept in the middle of a frame. */
const LONGEST_REST_MS = 1000;

/** A request for a drawing until it is drawn. */
interface Drawing {
  draw: () => void;
  /** True if it goes before all others. */
  isFirst: boolean;
}

/**
 * The drawings of all cards of the page, which share its animation frames. However often one is asked for, it shows the
 * newest, once per frame. Each frame draws those that go first, then others in the order in which they were asked for,
 * and then changes elements: to paint text on a canvas, a browser first lays out the changes of other cards.
 *
 * Where the others' frame took longer than a display's, they rest as long: of a page with too much to draw, half of the
 * time is left to those that go first, and to messages, which would queue.
 */
class Frames {
  readonly #waiting = new Set<Drawing>();
  /** Calls at the end of the frame that is being drawn; null outside of a frame. */
  #last: Set<() => void> | null = null;
  /** True while the drawings that do not go first rest. */
  #isResting = false;
  /** The drawings that were asked for in this task while the page prints; null without one. */
  #printed: Set<Drawing> | null = null;

  /** Draws everything that waits: a print has no animation frames. */
  print(): void {
    for (const drawing of [...this.#waiting]) this.#draw(drawing);
  }

  ask(drawing: Drawing): void {
    // A card that asks again, as while a recording plays, gets its next drawing after the print.
    if (isPrinting() && !this.#last && !this.#printed?.has(drawing)) {
      // Before the paper is laid out, but after the task: a view that is being made may not be complete yet.
      if (!this.#printed) queueMicrotask(() => this.#print());
      this.#printed ??= new Set();
      this.#printed.add(drawing);
      return;
    }
    if (!this.#waiting.size && !this.#last) requestAnimationFrame(() => this.#run());
    this.#waiting.add(drawing);
  }

  forget(drawing: Drawing): void {
    this.#waiting.delete(drawing);
    this.#printed?.delete(drawing);
  }

  /** Calls at the end of the frame that is being drawn, or else at once. */
  atEnd(call: () => void): void {
    if (this.#last) this.#last.add(call);
    else call();
  }

  /** Draws the requested drawings, and those that these ask for, once each. */
  #print(): void {
    for (const { draw } of this.#printed ?? []) attempt(draw);
    this.#printed = null;
  }

  #run(): void {
    const last = new Set<() => void>();
    this.#last = last;
    const [begin, all] = [performance.now(), [...this.#waiting]];
    const later = this.#isResting ? [] : all.filter(({ isFirst }) => !isFirst);
    for (const drawing of all) if (drawing.isFirst) this.#draw(drawing);
    for (const [i, drawing] of later.entries()) {
      // At least one: all get their turn, even if one takes the whole frame.
      if (i && performance.now() - begin > BUDGET_MS) break;
      this.#draw(drawing);
    }
    for (const call of last) attempt(call);
    this.#last = null;
    if (later.length) setTimeout(() => this.#rest(begin));
    if (this.#waiting.size) requestAnimationFrame(() => this.#run());
  }

  /** Called after a frame with others, which the browser has laid out and painted. */
  #rest(begin: number): void {
    const took = performance.now() - begin;
    if (took <= FRAME_MS) return;
    this.#isResting = true;
    setTimeout(
      () => {
        this.#isResting = false;
      },
      Math.min(took, LONGEST_REST_MS),
    );
  }

  #draw(drawing: Drawing): void {
    // Another one may have ended its view.
    if (this.#waiting.delete(drawing)) attempt(drawing.draw);
  }
}

/** Calls, and reports an error, so that other calls are not affected. */
function attempt(call: () => void): void {
  try {
    call();
  } catch (error) {
    reportError(error);
  }
}

const KEY: unique symbol = Symbol.for("robowidgets frames") as never;

/** The scripts of different widgets share only this object. */
const page = globalThis as { [KEY]?: Frames };

function frames(): Frames {
  if (!page[KEY]) {
    const made = new Frames();
    page[KEY] = made;
    onPrint("drawings", () => made.print());
  }
  return page[KEY];
}

/** Draws at most once per animation frame, in turn with all others of the page, or before them. */
export function perAnimationFrame(draw: () => void, signal: AbortSignal, isFirst = false): () => void {
  const drawing: Drawing = { draw, isFirst };
  onAbort(signal, () => frames().forget(drawing));
  return () => {
    if (!signal.aborted) frames().ask(drawing);
  };
}

/** Calls once all drawings of the animation frame are painted; at once outside of a frame. */
export function afterDrawings(call: () => void): void {
  frames().atEnd(call);
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

/** The texts at the sides of a picture. They are written after it is painted, in the same frame. */
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

  /** Writes a text after the present drawing, or, no oftener than users can read, after a later one. */
  ask(write: () => void): void {
    this.#waiting.add(write);
    this.#timer ??= setTimeout(() => this.write(true), LATE_MS);
  }

  /** Writes the requested texts, if it is time. @param isNow true to write them in any case */
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
