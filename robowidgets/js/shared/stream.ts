import { copyOf, type Reader, toBytes } from "./bytes.ts";
import { type Model, onChange, put } from "./model.ts";

/** What the head of every frame says. */
export interface Frame {
  /** How many samples Python had received when it sent this one. */
  sequence: number;
  /** Samples per second that reach Python; NaN when unknown. */
  rate: number;
}

/** Reads the head of a frame: its sequence number, the rate, and the stamp, which the page has no use for. */
export function readHead(reader: Reader): Frame {
  const [sequence = 0, rate = NaN] = reader.float64s(3);
  return { sequence, rate };
}

function sequenceOf(bytes: DataView | null): number {
  return bytes?.getFloat64(0, true) ?? 0;
}

const STALE_MS = 2000;
const NOTHING = new DataView(new ArrayBuffer(0));

/**
 * The newest sample and the frozen one, of one model and for all its views.
 *
 * Freezing happens here and not in Python, so that it works while a cell runs: the frozen bytes are a trait, which a
 * reload, a second view and a saved notebook find again.
 */
export class Stream<F extends Frame> {
  readonly #model: Model;
  readonly #decode: (bytes: DataView) => F;
  readonly #listeners = new Set<() => void>();
  #heldHere: DataView | null = null;
  #decoded: { bytes: DataView; frame: F } | null = null;
  #stale: ReturnType<typeof setTimeout> | undefined;
  /** Whether samples have come within the last seconds. */
  live = false;
  /** When the newest sample came, in the page's milliseconds. */
  arrived = 0;

  constructor(model: Model, decode: (bytes: DataView) => F, signal: AbortSignal) {
    this.#model = model;
    this.#decode = decode;
    onChange(model, ["_frame"], () => this.#onFrame(), signal);
    onChange(model, ["paused"], () => this.#onPaused(), signal);
    onChange(model, ["_held", "_about"], () => this.#tell(), signal);
    signal.addEventListener("abort", () => clearTimeout(this.#stale));
  }

  get paused(): boolean {
    return this.#model.get("paused") === true;
  }

  /** The frame to draw: the frozen one while paused, else the newest; null before the first. */
  get shown(): F | null {
    const bytes = this.#shownBytes();
    if (!bytes) return null;
    if (this.#decoded?.bytes !== bytes) this.#decoded = { bytes, frame: this.#decode(bytes) };
    return this.#decoded.frame;
  }

  /** How many samples have come since the frozen one. */
  get since(): number {
    return Math.max(0, sequenceOf(this.#bytes("_frame")) - sequenceOf(this.#shownBytes()));
  }

  toggle(): void {
    const paused = !this.paused;
    const held = paused && this.#bytes("_frame");
    // A copy, because hosts send the whole buffer under a view.
    put(this.#model, { _held: held ? new DataView(copyOf(held, 0, held.byteLength)) : NOTHING, paused });
  }

  /** Calls back on every change, until the signal ends it. */
  listen(callback: () => void, signal: AbortSignal): void {
    this.#listeners.add(callback);
    signal.addEventListener("abort", () => this.#listeners.delete(callback));
  }

  #shownBytes(): DataView | null {
    return this.paused ? (this.#bytes("_held") ?? this.#heldHere) : this.#bytes("_frame");
  }

  #bytes(name: "_frame" | "_held"): DataView | null {
    return toBytes(this.#model.get(name));
  }

  #onFrame(): void {
    this.live = true;
    this.arrived = performance.now();
    clearTimeout(this.#stale);
    this.#stale = setTimeout(() => {
      this.live = false;
      this.#tell();
    }, STALE_MS);
    this.#tell();
  }

  #onPaused(): void {
    // A link between widgets says "paused" alone.
    this.#heldHere = this.paused ? this.#bytes("_frame") : null;
    this.#tell();
  }

  #tell(): void {
    for (const listener of this.#listeners) listener();
  }
}
