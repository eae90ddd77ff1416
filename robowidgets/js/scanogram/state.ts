import { toBytes } from "../shared/bytes.ts";
import { onAbort } from "../shared/events.ts";
import { markBeside } from "../shared/marks.ts";
import { type Model, onChange, setTraits } from "../shared/model.ts";
import { throttle } from "../shared/schedule.ts";
import type { StateSpan } from "../shared/states/states.ts";
import type { Span } from "../shared/time_axis.ts";
import type { Pointing } from "../shared/traits.ts";
import { Blocks } from "./blocks.ts";
import { type Detail, decodeDetail, decodeWhole, type NamedSpan, type Whole } from "./data.ts";
import type { Pixel, ScanogramTraits } from "./traits.ts";

const ASK_MS = 120;
const LATE_MS = 400;

/** State that the views of one model share: the scans in the page, and requests for finer detail. */
export class State {
  readonly #model: Model<ScanogramTraits & Pointing>;
  readonly #ask: () => void;
  readonly #signal: AbortSignal;
  readonly #listeners = new Set<() => void>();
  #known: { bytes: unknown; whole: Whole; blocks: Blocks } | null = null;
  #seen: { span: Span; columns: number } | null = null;
  #asked = "";
  #late: ReturnType<typeof setTimeout> | undefined;
  /** True while a request for finer detail has been unanswered for a while. */
  waits = false;

  constructor(model: Model<ScanogramTraits & Pointing>, signal: AbortSignal) {
    this.#model = model;
    this.#signal = signal;
    this.#ask = throttle(() => this.#askNow(), ASK_MS, signal);
    const tell = () => this.#tell();
    onChange(model, ["_frame", "_about", "view", "color_range", "pixel", "marks", "states"], tell, signal);
    onChange(model, ["_detail"], () => this.#onDetail(), signal);
    onAbort(signal, () => clearTimeout(this.#late));
  }

  listen(callback: () => void, signal: AbortSignal): void {
    this.#listeners.add(callback);
    onAbort(signal, () => this.#listeners.delete(callback));
  }

  get whole(): Whole | null {
    return this.#decoded?.whole ?? null;
  }

  get blocks(): Blocks | null {
    return this.#decoded?.blocks ?? null;
  }

  get time(): number {
    return this.#model.get("time");
  }

  get selection(): number[] | null {
    return this.#model.get("selection");
  }

  get marks(): NamedSpan[] {
    return this.#model.get("marks").map(([start, end, name]) => ({ start, end, name }));
  }

  get states(): StateSpan[][] {
    return this.#model.get("states");
  }

  /** The start of the next or the previous mark. */
  markBeside(direction: -1 | 1): number | undefined {
    return markBeside(this.#model.get("marks"), this.time, direction);
  }

  /** The time on show. */
  get view(): Span {
    const whole = this.whole?.span ?? [0, 1];
    const [start, end] = this.#model.get("view") ?? whole;
    return start < whole[1] && end > whole[0] ? [start, end] : whole;
  }

  /** The ends of the colours that are set; null if they are fitted to the readings. */
  get colors(): [number, number] | null {
    return this.#model.get("color_range");
  }

  get pixel(): Pixel {
    return this.#model.get("pixel");
  }

  /** True while the page lacks the cells for the wanted reading of each pixel. */
  get lacksPixels(): boolean {
    const whole = this.whole;
    return whole !== null && whole.pixel !== this.pixel && (whole.block.size > 1 || whole.block.rayStep > 1);
  }

  /** Index of the ray at which the user points on another widget. */
  get ray(): number | null {
    return this.#model.get("_ray") ?? null;
  }

  /** Sets traits in the page at once and sends them to Python. */
  set(values: Partial<ScanogramTraits>): void {
    setTraits(this.#model, values);
  }

  /** Publishes the time and the ray under the pointer in the page, where a player shows them in all its widgets. */
  point(pointed: Pointing["_pointed"]): void {
    this.#model.set("_pointed", pointed);
  }

  /** Requests the missing detail of a span that a view shows in some number of columns. */
  look(span: Span, columns: number): void {
    this.#seen = { span, columns };
    if (this.blocks?.wants(span, columns)) this.#ask();
    else this.#settle();
  }

  get #decoded() {
    const given = this.#model.get("_frame");
    if (this.#known?.bytes === given) return this.#known;
    const bytes = toBytes(given);
    if (!bytes) return null;
    const whole = decodeWhole(bytes);
    this.#known = { bytes: given, whole, blocks: new Blocks(whole) };
    this.#asked = "";
    this.#take(this.#known.blocks, whole);
    return this.#known;
  }

  #askNow(): void {
    const seen = this.#seen;
    if (!seen || !this.blocks?.wants(seen.span, seen.columns)) return;
    const wanted = [...seen.span, seen.columns];
    const asked = wanted.join();
    if (asked === this.#asked) return;
    this.#asked = asked;
    setTraits(this.#model, { _wanted: wanted });
    if (this.#late === undefined && !this.waits) {
      this.#late = setTimeout(() => {
        this.waits = true;
        this.#tell();
      }, LATE_MS);
    }
  }

  #onDetail(): void {
    const whole = this.whole;
    const detail = whole && this.blocks && this.#take(this.blocks, whole);
    // Answers to earlier requests may come first; only the answer to the last request ends the wait.
    if (detail && this.#asked.startsWith(`${detail.span},`)) this.#settle();
    this.#tell();
  }

  /** Adds the detail that Python sent, or that was in the state at page load. */
  #take(blocks: Blocks, whole: Whole): Detail | null {
    const bytes = toBytes(this.#model.get("_detail"));
    if (!bytes) return null;
    const detail = decodeDetail(bytes, whole.sweep);
    blocks.add(detail);
    return detail;
  }

  #settle(): void {
    clearTimeout(this.#late);
    this.#late = undefined;
    this.waits = false;
  }

  #tell(): void {
    if (this.#signal.aborted) return;
    for (const listener of this.#listeners) listener();
  }
}
