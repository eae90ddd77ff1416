import { copyOf, type Reader, toBytes } from "./bytes.ts";
import { onAbort } from "./events.ts";
import { History } from "./history.ts";
import { type Model, onChange, setTraits } from "./model.ts";
import { throttle } from "./schedule.ts";
import { firstWhere } from "./search.ts";
import { silentAfter } from "./staleness.ts";
import { join, type Member, othersOf, setFrozen, tellOthers } from "./together.ts";
import type { About, Moment, Recent, SampleTraits } from "./traits.ts";

/** The header of a frame, without the parts that the page does not use. */
export interface Frame {
  /** Number of samples that Python had received when it sent this one. */
  sequence: number;
  /** Samples per second that reach Python; NaN when unknown. */
  rate: number;
  /** Seconds of Python's monotonic clock. */
  arrived: number;
}

/** Reads the header of a frame; the page does not use the stamp in it. */
export function readHead(reader: Reader): Frame {
  const [sequence = 0, rate = NaN, , arrived = 0] = reader.float64s(4);
  return { sequence, rate, arrived };
}

export function sequenceOf(bytes: DataView | null): number {
  return bytes?.getFloat64(0, true) ?? 0;
}

/** Seconds of Python's monotonic clock at which a sample arrived. */
function arrivalOf(bytes: DataView): number {
  return bytes.getFloat64(24, true);
}

/** Position of the frozen sample in the history. */
export interface Place {
  /** -1 when it is not in the history. */
  index: number;
  count: number;
  /** Milliseconds from it to the newest; NaN when it arrived before the page was loaded. */
  behind: number;
}

const SAVE_MS = 100;
const NOTHING = /* @__PURE__ */ new DataView(new ArrayBuffer(0));

/**
 * The newest sample, its history and the frozen sample of one model; its views share it.
 *
 * Freezing happens in the page, so that it works while a cell runs. The frozen bytes are a trait, so that a reload, a
 * second view and a saved notebook show them.
 */
export class Stream<F extends Frame> implements Member {
  readonly #model: Model<SampleTraits>;
  readonly #decode: (bytes: DataView) => F;
  readonly #history = new History();
  /** Decoded samples of the history. */
  readonly #frames = new WeakMap<DataView, F>();
  readonly #save: () => void;
  readonly #listeners = new Set<() => void>();
  /** While `paused` is set without `_frozen_frame`. */
  #frozenHere: DataView | null = null;
  /** The frozen sample, if the history had it: a history of 0 seconds soon drops the one to which a player stepped. */
  #frozen: Moment | undefined;
  #decoded: { bytes: DataView; frame: F } | null = null;
  #stale: ReturnType<typeof setTimeout> | undefined;
  /** Time of the last sample, which may be before the page was loaded; 0 without a sample. */
  #heard = 0;
  /** False while the source is silent. */
  live = false;
  /** Time at which the newest frame arrived, in milliseconds of the page's clock. */
  arrived = 0;
  /** True once the user has stepped away from the sample that was frozen. */
  stepped = false;

  constructor(model: Model<SampleTraits>, decode: (bytes: DataView) => F, signal: AbortSignal) {
    this.#model = model;
    this.#decode = decode;
    // While the user drags, Python needs no message for each step.
    this.#save = throttle(() => model.save_changes(), SAVE_MS, signal);
    const [frozen, newest] = [this.paused ? this.#bytes("_frozen_frame") : null, this.#bytes("_frame")];
    this.#keep(frozen, NaN);
    if (this.paused) this.#history.freeze(performance.now());
    if (sequenceOf(frozen) !== sequenceOf(newest)) this.#keep(newest, NaN);
    this.#takeAge();
    onChange(model, ["_frame"], () => this.#onFrame(), signal);
    // A page that connects again may get a sample long after Python did.
    onChange(model, ["_silence"], () => this.#takeAge(), signal);
    onChange(model, ["paused"], () => this.#onPaused(), signal);
    onChange(model, ["_frozen_frame"], () => this.#onFrozen(), signal);
    onChange(model, ["_about"], () => this.#onAbout(), signal);
    onChange(model as Model<Recent>, ["_recent"], () => this.#tell(), signal);
    onChange(model, ["_together"], () => tellOthers(this), signal);
    onAbort(signal, () => clearTimeout(this.#stale));
    join(this, signal);
  }

  get group(): string {
    return this.#model.get("_together");
  }

  get robot(): string {
    return this.#model.get("_source").robot ?? "";
  }

  get oldest(): number {
    const [first] = this.#history.moments;
    // Without a history it does not follow steps.
    return first && this.#seconds && this.#history.hasDropped ? arrivalOf(first.bytes) : -Infinity;
  }

  get paused(): boolean {
    return this.#model.get("paused");
  }

  /** The frame to draw: the frozen one while paused, else the newest; null before the first. */
  get shown(): F | null {
    const { bytes } = this;
    if (!bytes) return null;
    if (this.#decoded?.bytes !== bytes) this.#decoded = { bytes, frame: this.#decode(bytes) };
    return this.#decoded.frame;
  }

  /** Facts about the frame to draw, from Python. */
  get about(): About {
    const frozen = this.paused ? (this.#frozen ?? this.#history.moments[this.#index]) : undefined;
    return frozen?.about ?? this.#model.get("_about");
  }

  /** Number of samples since the frozen one. */
  get since(): number {
    return Math.max(0, sequenceOf(this.#bytes("_frame")) - sequenceOf(this.bytes));
  }

  /** Samples per second that reach Python; NaN when unknown. */
  get rate(): number {
    return this.#bytes("_frame")?.getFloat64(8, true) ?? NaN;
  }

  /** Milliseconds since the last sample of a silent feed, of a source that had a rate, or of a recording; else 0. */
  get silence(): number {
    const wasLive = this.#heard && !this.live && (this.rate || this.#model.get("_source").topic);
    return wasLive ? performance.now() - this.#heard : (this.#model.get("_about").age ?? 0);
  }

  /** Null while the picture is not frozen, or if the history has no other sample. */
  get place(): Place | null {
    const { moments } = this.#history;
    const [count, newest] = [moments.length, moments.at(-1)];
    if (!this.paused || !this.#seconds || !newest || count < 2) return null;
    const index = this.#index;
    return { index, count, behind: newest.at - (moments[index]?.at ?? NaN) };
  }

  /** Index of the sample on show in the history, or -1. */
  get #index(): number {
    const { moments } = this.#history;
    if (!this.paused) return moments.length - 1;
    const { bytes } = this;
    const own = moments.findIndex((moment) => moment.bytes === bytes);
    // A frame frozen by Python, or found at page load, is not an object of the history: compare sequences.
    return own < 0 ? moments.map((m) => sequenceOf(m.bytes)).lastIndexOf(sequenceOf(bytes)) : own;
  }

  /** The samples of the history, oldest first. */
  get moments(): readonly Moment[] {
    return this.#history.moments;
  }

  /** The last samples up to the one on show, oldest first, at most so many: of the history, or as a player gives them. */
  last(count: number): Moment[] {
    // A saved notebook has no bytes in it.
    const given = (this.#model as Model<Recent>).get("_recent")?.filter(({ bytes }) => bytes instanceof DataView);
    return (given ?? this.moments.slice(0, this.#index + 1)).slice(-count);
  }

  /** The frame of a sample, decoded once. */
  frameOf({ bytes }: Moment): F {
    const frame = this.#frames.get(bytes) ?? this.#decode(bytes);
    this.#frames.set(bytes, frame);
    return frame;
  }

  /** The bytes of the frame to draw; null before the first. */
  get bytes(): DataView | null {
    return this.paused ? (this.#bytes("_frozen_frame") ?? this.#frozenHere) : this.#bytes("_frame");
  }

  /** The frame so many samples before the one to draw, or the next older one; null if none is kept. */
  before(count: number): DataView | null {
    const last = (this.shown?.sequence ?? NaN) - count;
    return this.#history.moments.filter(({ bytes }) => sequenceOf(bytes) <= last).at(-1)?.bytes ?? null;
  }

  /** Freezes the picture, or releases it, with the others of its view. */
  toggle(): void {
    setFrozen([this, ...othersOf(this)], !this.paused);
  }

  freeze(): void {
    if (!this.paused)
      setTraits(this.#model, { _frozen_frame: this.#history.moments.at(-1)?.bytes || NOTHING, paused: true });
  }

  release(): void {
    if (this.paused) setTraits(this.#model, { _frozen_frame: NOTHING, paused: false });
  }

  /** Shows the next or the previous sample of the history; returns false without samples to step through. */
  step(by: number): boolean {
    const { place } = this;
    if (!place || !by) return false;
    this.seek(place.index + by);
    return true;
  }

  /**
   * Shows a sample of the history, and the others of its view at its moment; an index beyond an end is clamped, also
   * beyond the samples that the others have kept.
   */
  seek(index: number): void {
    const { moments } = this.#history;
    const others = othersOf(this);
    const oldest = Math.max(...others.map((other) => other.oldest));
    const first = firstWhere(moments, ({ bytes }) => arrivalOf(bytes) >= oldest);
    const moment = moments[Math.min(moments.length - 1, Math.max(0, first, index))];
    if (!moment || !this.paused) return;
    this.#show(moment);
    for (const other of others) other.showAt(arrivalOf(moment.bytes));
  }

  /**
   * Freezes the pictures of its view at a moment: this one at its first sample since then, the others at their newest
   * sample of that moment. Returns false if the sample is not kept.
   */
  freezeAt(arrived: number): boolean {
    const { moments } = this.#history;
    const own = moments[firstWhere(moments, ({ bytes }) => arrivalOf(bytes) >= arrived)];
    const others = othersOf(this);
    // After a gap, or in the state at page load, it need not be the first since then.
    const isFirst = own?.at && !own.isAfterGap;
    if (!this.#seconds || !isFirst || [this, ...others].some((one) => one.oldest > arrived)) return false;
    if (!this.paused) this.toggle();
    this.#show(own);
    for (const other of others) {
      other.freeze();
      other.showAt(arrived);
    }
    return true;
  }

  showAt(arrived: number): void {
    const { moments } = this.#history;
    const next = firstWhere(moments, ({ bytes }) => arrivalOf(bytes) > arrived);
    const moment = moments[Math.max(0, next - 1)];
    if (moment && this.paused && this.#seconds) this.#show(moment);
  }

  #show({ bytes }: Moment): void {
    this.stepped = true;
    this.#model.set("_frozen_frame", bytes);
    this.#save();
  }

  /** Calls back on every change, until the signal aborts. */
  listen(callback: () => void, signal: AbortSignal): void {
    this.#listeners.add(callback);
    onAbort(signal, () => this.#listeners.delete(callback));
  }

  #bytes(name: "_frame" | "_frozen_frame"): DataView | null {
    return toBytes(this.#model.get(name));
  }

  get #seconds(): number {
    return this.#model.get("history") || 0;
  }

  /** Copies the frame: hosts hand out views of larger buffers, and would send the whole buffer under a view. */
  #keep(bytes: DataView | null, at: number): void {
    if (!bytes) return;
    const kept = new DataView(copyOf(bytes, 0, bytes.byteLength));
    this.#history.add(kept, at, this.#seconds, this.#model.get("_about"));
  }

  #onFrame(): void {
    const [bytes, before] = [this.#bytes("_frame"), this.#history.moments.at(-1)?.bytes];
    // A frame may add to the same sample: a command to a speed, the end of a touch.
    const isSame =
      bytes && before && sequenceOf(bytes) === sequenceOf(before) && arrivalOf(bytes) === arrivalOf(before);
    if (!isSame) this.#hear(this.#age);
    this.arrived = performance.now();
    this.#keep(bytes, this.arrived);
    this.#tell();
  }

  /** Keeps later facts about the newest sample: a program looks at a scan before it draws on it. */
  #onAbout(): void {
    const newest = this.#history.moments.at(-1);
    if (newest && sequenceOf(newest.bytes) === sequenceOf(this.#bytes("_frame"))) {
      newest.about = this.#model.get("_about");
    }
    this.#tell();
  }

  /** Notes the age of the newest sample, which Python sends with its whole state. */
  #takeAge(): void {
    if (!this.#age) return;
    this.#hear(this.#age);
    // A notebook that is saved later must not restore this age. It may arrive before the frame that it belongs to.
    queueMicrotask(() => this.#model.set("_silence", 0));
  }

  /** Milliseconds since the newest sample, right after Python has sent its whole state; else 0. */
  get #age(): number {
    return 1000 * (this.#model.get("_silence") || 0);
  }

  /** Notes that a sample arrived some milliseconds ago. */
  #hear(ago: number): void {
    this.live = true;
    this.#heard = performance.now() - ago;
    clearTimeout(this.#stale);
    const stale = () => {
      this.live = false;
      this.#tell();
    };
    this.#stale = setTimeout(stale, silentAfter(1000 / (this.rate || 0)) - ago);
  }

  #onFrozen(): void {
    this.#frozen = this.#history.moments[this.#index];
    this.#tell();
  }

  #onPaused(): void {
    this.stepped = false;
    // A link between two widgets sets `paused` without `_frozen_frame`.
    this.#frozenHere = this.paused ? (this.#history.moments.at(-1)?.bytes ?? null) : null;
    if (this.paused) this.#history.freeze(performance.now());
    else this.#history.release(this.#seconds);
    this.#onFrozen();
    tellOthers(this);
  }

  #tell(): void {
    for (const listener of this.#listeners) listener();
  }
}
