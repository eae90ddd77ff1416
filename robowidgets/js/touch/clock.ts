/** The parts of a stream that the clock reads. */
interface Arrivals {
  readonly paused: boolean;
  readonly arrived: number;
  readonly stepped: boolean;
  listen(callback: () => void, signal: AbortSignal): void;
}

/** The age of the frame on show. It stops while the picture is frozen. */
export class Clock {
  readonly #stream: Arrivals;
  readonly #now: () => number;
  #frozenAt: number | null | undefined;

  constructor(stream: Arrivals, signal: AbortSignal, now = () => performance.now()) {
    this.#stream = stream;
    this.#now = now;
    stream.listen(() => this.#follow(), signal);
    this.#follow();
  }

  get runs(): boolean {
    return this.#frozenAt === undefined && this.#stream.arrived > 0;
  }

  /** Seconds since the frame on show arrived; null if it was in the state at page load. */
  get elapsed(): number | null {
    if (this.#frozenAt !== undefined) return this.#frozenAt;
    return this.runs ? Math.max(0, this.#now() - this.#stream.arrived) / 1000 : null;
  }

  #follow(): void {
    if (!this.#stream.paused) this.#frozenAt = undefined;
    // A frame that was stepped to has the age of its arrival.
    else if (this.#stream.stepped) this.#frozenAt = 0;
    else if (this.#frozenAt === undefined) this.#frozenAt = this.elapsed;
  }
}
