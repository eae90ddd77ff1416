import { copyOf, type Reader, toBytes } from "./bytes.ts";
import { onAbort } from "./events.ts";
import { History } from "./history.ts";
import { type Model, onChange, setTraits } from "./model.ts";
import { throttle } from "./schedule.ts";
import type { About, SampleTraits } from "./traits.ts";

/** What the head of every frame says. */
export interface Frame {
  /** How many samples Python had received when it sent this one. */
  sequence: number;
  /** Samples per second that reach Python; NaN when unknown. */
  rate: number;
}

/** Reads the head of a frame: sequence number and rate; then stamp and arrival, which the page has no use for. */
export function readHead(reader: Reader): Frame {
  const [sequence = 0, rate = NaN] = reader.float64s(4);
  return { sequence, rate };
}

function sequenceOf(bytes: DataView | null): number {
  return bytes?.getFloat64(0, true) ?? 0;
}

/** Where the frozen sample stands among those kept. */
export interface Place {
  /** -1 when it is not among them. */
  index: number;
  count: number;
  /** Milliseconds between it and the newest; NaN when this page did not see it come. */
  behind: number;
}

/**
 * Milliseconds without a frame after which a source is silent, as in Python: three of its periods, within these limits,
 * and the longest where it has no rate yet.
 */
const SHORTEST_SILENCE = 1000;
const LONGEST_SILENCE = 10_000;
const SAVE_MS = 100;
const NOTHING = /* @__PURE__ */ new DataView(new ArrayBuffer(0));

/**
 * The newest sample, those before it and the frozen one, of one model and for all its views.
 *
 * Freezing happens here and not in Python, so that it works while a cell runs: the frozen bytes are a trait, which a
 * reload, a second view and a saved notebook find again.
 */
export class Stream<F extends Frame> {
  readonly #model: Model<SampleTraits>;
  readonly #decode: (bytes: DataView) => F;
  readonly #history = new History();
  readonly #save: () => void;
  readonly #listeners = new Set<() => void>();
  #heldHere: DataView | null = null;
  #decoded: { bytes: DataView; frame: F } | null = null;
  #stale: ReturnType<typeof setTimeout> | undefined;
  /** When the source was heard last, which may be before the page was loaded; 0: never. */
  #heard = 0;
  /** Whether the source is not silent. */
  live = false;
  /** When the newest sample came, in the page's milliseconds. */
  arrived = 0;
  /** Whether another sample than the one that froze was stepped to. */
  stepped = false;

  constructor(model: Model<SampleTraits>, decode: (bytes: DataView) => F, signal: AbortSignal) {
    this.#model = model;
    this.#decode = decode;
    // A person who drags need not be followed by Python to the millisecond.
    this.#save = throttle(() => model.save_changes(), SAVE_MS, signal);
    const [held, newest] = [this.paused ? this.#bytes("_held") : null, this.#bytes("_frame")];
    this.#keep(held, NaN);
    if (this.paused) this.#history.hold(performance.now());
    if (sequenceOf(held) !== sequenceOf(newest)) this.#keep(newest, NaN);
    const age = model.get("_silence");
    if (age) {
      // A notebook that is saved later shows it as if it were new.
      model.set("_silence", 0);
      this.#hear(1000 * age);
    }
    onChange(model, ["_frame"], () => this.#onFrame(), signal);
    onChange(model, ["paused"], () => this.#onPaused(), signal);
    onChange(model, ["_held", "_about"], () => this.#tell(), signal);
    onAbort(signal, () => clearTimeout(this.#stale));
  }

  get paused(): boolean {
    return this.#model.get("paused");
  }

  /** The frame to draw: the frozen one while paused, else the newest; null before the first. */
  get shown(): F | null {
    const bytes = this.#shownBytes();
    if (!bytes) return null;
    if (this.#decoded?.bytes !== bytes) this.#decoded = { bytes, frame: this.#decode(bytes) };
    return this.#decoded.frame;
  }

  /** What is said of the frame to draw. */
  get about(): About {
    return this.#history.moments[this.place?.index ?? -1]?.about ?? this.#model.get("_about");
  }

  /** How many samples have come since the frozen one. */
  get since(): number {
    return Math.max(0, sequenceOf(this.#bytes("_frame")) - sequenceOf(this.#shownBytes()));
  }

  /** Samples per second that reach Python; NaN when unknown. */
  get rate(): number {
    return this.#bytes("_frame")?.getFloat64(8, true) ?? NaN;
  }

  /** Milliseconds for which nothing has come, of a feed, of a source that had a rate, or of a recording; else 0. */
  get silence(): number {
    const wasLive = this.#heard && !this.live && (this.rate || this.#model.get("_source").topic);
    return wasLive ? performance.now() - this.#heard : (this.#model.get("_about").age ?? 0);
  }

  /** Null when the picture is not frozen, or there is nothing to step to. */
  get place(): Place | null {
    const { moments } = this.#history;
    const [count, newest] = [moments.length, moments.at(-1)];
    if (!this.paused || !this.#seconds || !newest || count < 2) return null;
    const bytes = this.#shownBytes();
    const own = moments.findIndex((moment) => moment.bytes === bytes);
    // Python holds a frame of its own, and so does a page that was loaded anew.
    const index = own < 0 ? moments.map((m) => sequenceOf(m.bytes)).lastIndexOf(sequenceOf(bytes)) : own;
    return { index, count, behind: newest.at - (moments[index]?.at ?? NaN) };
  }

  toggle(): void {
    const paused = !this.paused;
    setTraits(this.#model, { _held: (paused && this.#history.moments.at(-1)?.bytes) || NOTHING, paused });
  }

  /** Shows the next of the samples kept, or the one before; whether it is frozen with some to step through. */
  step(by: number): boolean {
    const { place } = this;
    if (!place || !by) return false;
    this.seek(place.index + by);
    return true;
  }

  /** Shows another of the samples kept; beyond an end, the one at that end. */
  seek(index: number): void {
    const { moments } = this.#history;
    const moment = moments[Math.min(moments.length - 1, Math.max(0, index))];
    if (!moment || !this.paused) return;
    this.stepped = true;
    this.#model.set("_held", moment.bytes);
    this.#save();
  }

  /** Calls back on every change, until the signal ends it. */
  listen(callback: () => void, signal: AbortSignal): void {
    this.#listeners.add(callback);
    onAbort(signal, () => this.#listeners.delete(callback));
  }

  #shownBytes(): DataView | null {
    return this.paused ? (this.#bytes("_held") ?? this.#heldHere) : this.#bytes("_frame");
  }

  #bytes(name: "_frame" | "_held"): DataView | null {
    return toBytes(this.#model.get(name));
  }

  get #seconds(): number {
    return this.#model.get("history") || 0;
  }

  /** Keeps a copy, because hosts hand out views of larger buffers, and send the whole buffer under a view. */
  #keep(bytes: DataView | null, at: number): void {
    if (!bytes) return;
    const kept = new DataView(copyOf(bytes, 0, bytes.byteLength));
    this.#history.add(kept, at, this.#seconds, this.#model.get("_about"));
  }

  #onFrame(): void {
    this.#hear();
    this.arrived = this.#heard;
    this.#keep(this.#bytes("_frame"), this.arrived);
    this.#tell();
  }

  /** The source was heard so many milliseconds ago. */
  #hear(ago = 0): void {
    this.live = true;
    this.#heard = performance.now() - ago;
    clearTimeout(this.#stale);
    const stale = () => {
      this.live = false;
      this.#tell();
    };
    const limit = Math.min(LONGEST_SILENCE, Math.max(SHORTEST_SILENCE, 3000 / (this.rate || 0)));
    this.#stale = setTimeout(stale, limit - ago);
  }

  #onPaused(): void {
    this.stepped = false;
    // A link between widgets says "paused" alone.
    this.#heldHere = this.paused ? (this.#history.moments.at(-1)?.bytes ?? null) : null;
    if (this.paused) this.#history.hold(performance.now());
    else this.#history.release(this.#seconds);
    this.#tell();
  }

  #tell(): void {
    for (const listener of this.#listeners) listener();
  }
}
