/** What the clock needs of a stream. */
interface Arrivals {
  readonly paused: boolean;
  readonly arrived: number;
  listen(callback: () => void, signal: AbortSignal): void;
}

/** How old the frame on show is. It stands still while the picture is frozen, and before the first frame of this page. */
export class Clock {
  readonly #stream: Arrivals;
  readonly #now: () => number;
  #frozenAt: number | null = null;

  constructor(stream: Arrivals, signal: AbortSignal, now = () => performance.now()) {
    this.#stream = stream;
    this.#now = now;
    stream.listen(() => this.#follow(), signal);
    this.#follow();
  }

  get runs(): boolean {
    return this.#frozenAt === null && this.#stream.arrived > 0;
  }

  /** Seconds since the frame on show came. */
  get elapsed(): number {
    if (this.#frozenAt !== null) return this.#frozenAt;
    return this.runs ? Math.max(0, this.#now() - this.#stream.arrived) / 1000 : 0;
  }

  #follow(): void {
    if (!this.#stream.paused) this.#frozenAt = null;
    else this.#frozenAt ??= this.elapsed;
  }
}
