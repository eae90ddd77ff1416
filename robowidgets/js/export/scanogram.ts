import type { SegmentMessage } from "../player/traits.ts";
import { type Facts, type Numbers, type Sweep, toCode, toSweep, unpack } from "../scanogram/data.ts";
import { Reader } from "../shared/bytes.ts";
import { firstWhere } from "../shared/search.ts";
import { SCAN_GAP_STEPS } from "../shared/staleness.ts";
import { onRays } from "./by_angle.ts";
import type { Segments } from "./feed.ts";
import type { PageModel } from "./model.ts";

/** Most bytes of the overview and of a detail, and most rows; Python has the same numbers. */
const OVERVIEW_BYTES = 1e6;
const DETAIL_BYTES = 3e6;
const MOST_ROWS = 2048;
/** Before and after the span that the page asks for, as a part of it. */
const MARGIN = 0.5;
const NO_PAUSE = 0.1;
/**
 * Bytes of a laser's frame before its ranges; the last of these bytes, which describe its rays; and the place of its
 * limits among them.
 */
const HEAD = 72;
const GEOMETRY = 40;
const LIMITS = 16;

interface TimedRanges {
  time: number;
  ranges: Float32Array;
}

/** Neighbouring cells, as `scanogram/page_parts.py` makes them. */
interface Part {
  level: number;
  first: number;
  starts: Float64Array;
  ends: Float64Array;
  cells: Uint16Array | Float32Array;
}

/** Makes the picture of a scanogram from the scans in the page, which Python has left out, and its finer details. */
export class ScanogramMaker {
  readonly #model: PageModel;
  readonly #segments: Segments;
  readonly #track: number;
  readonly #facts: Facts;
  readonly #others: Map<string, Numbers>;
  readonly #sweep: Sweep;
  readonly #rayStep: number;
  readonly #rows: number;
  /** By segment, the times of its scans, and their codes one after the other. */
  readonly #seen = new Map<number, { times: number[]; codes: Uint16Array }>();
  #starts = new Float64Array();
  #ends = new Float64Array();
  #codes = new Uint16Array();
  #pause = NO_PAUSE;

  /** @param track the number of the widget that shows these scans */
  constructor(model: PageModel, segments: Segments, track: number) {
    this.#model = model;
    this.#segments = segments;
    this.#track = track;
    const { facts, arrays } = unpack(model.get("_frame"));
    this.#facts = facts;
    this.#others = arrays;
    this.#sweep = toSweep(facts);
    this.#rayStep = Math.max(1, Math.ceil(facts.ray_count / MOST_ROWS));
    this.#rows = Math.ceil(facts.ray_count / this.#rayStep);
    model.set_state({ _frame: null });
    segments.listen((message) => this.#see(message));
  }

  /** Puts the picture on show, once all scans were read. */
  async run(): Promise<void> {
    for (const number of this.#segments.numbers) if (!this.#seen.has(number)) await this.#segments.read(number);
    const seen = this.#segments.numbers.map((number) => this.#seen.get(number));
    this.#setClock(seen.flatMap((segment) => segment?.times ?? []));
    const count = this.#starts.length;
    this.#codes = new Uint16Array(count * this.#rows);
    let at = 0;
    for (const segment of seen) {
      this.#codes.set(segment?.codes ?? [], at);
      at += segment?.codes.length ?? 0;
    }
    await this.#draw();
    this.#model.on("change:pixel", () => this.#draw());
    this.#model.on("change:_wanted", () => this.#look(this.#model.get("_wanted")));
  }

  /** The picture, as nearest readings or as medians. */
  async #draw(): Promise<void> {
    const pixel = this.#model.get("pixel");
    const whole = await this.#part(0, this.#starts.length, 0, OVERVIEW_BYTES);
    this.#facts.edition++;
    const facts = { ...this.#facts, pixel, scan_count: this.#starts.length, pause: this.#pause };
    this.#model.set_state({ _wanted: [], _frame: this.#pack(facts, whole, this.#others) });
  }

  #see(message: SegmentMessage): void {
    if (this.#seen.has(message.segment)) return;
    const scans = this.#scansOf(message);
    const codes = new Uint16Array(scans.length * this.#rows).fill(0xffff);
    for (const [i, { ranges }] of scans.entries()) {
      for (let ray = 0; ray < ranges.length; ray++) {
        const place = i * this.#rows + Math.floor(ray / this.#rayStep);
        const code = toCode(ranges[ray] as number, this.#sweep);
        if (code < (codes[place] as number)) codes[place] = code;
      }
    }
    this.#seen.set(message.segment, { times: scans.map(({ time }) => time), codes });
  }

  /** Sets the start and end of each scan: a scan ends at the start of the next one, or at a gap. */
  #setClock(times: number[]): void {
    this.#starts = Float64Array.from(times);
    const steps = times.slice(1).map((time, i) => time - (times[i] as number));
    const moving = steps.filter((step) => step > 0).sort((a, b) => a - b);
    this.#pause = moving[Math.floor(moving.length / 2)] ?? NO_PAUSE;
    const gap = SCAN_GAP_STEPS * (moving[Math.floor((moving.length * 9) / 10)] ?? NO_PAUSE);
    this.#ends = this.#starts.map((start, i) => start + ((steps[i] ?? Infinity) > gap ? this.#pause : (steps[i] ?? 0)));
  }

  /** The scans between two times: the number of the first, and the number after the last. */
  #between(start: number, end: number): [number, number] {
    const first = firstWhere(this.#ends, (time) => time > start);
    return [
      first,
      Math.max(
        first,
        firstWhere(this.#starts, (time) => time >= end),
      ),
    ];
  }

  async #look([start, end, columns]: number[]): Promise<void> {
    if (start === undefined || end === undefined || !columns) return;
    const [first, stop] = this.#between(start, end);
    const wanted = Math.max(0, Math.floor(Math.log2(Math.max(1, Math.floor((stop - first) / columns)))));
    const margin = MARGIN * (end - start);
    const wide = await this.#part(...this.#between(start - margin, end + margin), wanted, DETAIL_BYTES);
    const part = wide.level === wanted ? wide : await this.#part(first, stop, wanted, DETAIL_BYTES);
    const facts = { edition: this.#facts.edition, span: [start, end] };
    this.#model.set_state({ _detail: this.#pack(facts, part) });
  }

  /** Some scans, at a level or the first coarser level that fits into some bytes. */
  async #part(first: number, stop: number, finest: number, most: number): Promise<Part> {
    const [rows, starts, ends] = [this.#rows, this.#starts, this.#ends];
    let level = finest;
    while (stop - first > 1 << level && 2 * rows * (((stop - first) >> level) + 2) > most) level++;
    const size = 1 << level;
    const firsts: number[] = [];
    for (let scan = first - (first % size); scan < stop; scan += size) firsts.push(scan);
    const isExact = level === 0 && this.#rayStep === 1 && 4 * rows * (stop - first) <= most;
    return {
      level,
      first: firsts[0] ?? first,
      starts: Float64Array.from(firsts, (scan) => starts[scan] as number),
      ends: Float64Array.from(firsts, (scan) => ends[Math.min(scan + size, ends.length) - 1] as number),
      cells: isExact ? await this.#ranges(first, stop) : this.#fold(firsts, size),
    };
  }

  /** The code of each ray in some cells: the least, or the median; for an even number, the lower middle one. */
  #fold(firsts: number[], size: number): Uint16Array {
    const rows = this.#rows;
    const middle = this.#model.get("pixel") === "median";
    const cells = new Uint16Array(firsts.length * rows);
    for (const [cell, first] of firsts.entries()) {
      const count = Math.min(size, this.#starts.length - first);
      const codes = new Uint16Array(count);
      for (let row = 0; row < rows; row++) {
        let least = 0xffff;
        for (let i = 0; i < count; i++) {
          const code = this.#codes[(first + i) * rows + row] as number;
          codes[i] = code;
          if (code < least) least = code;
        }
        cells[cell * rows + row] = middle ? (codes.sort()[(count - 1) >> 1] as number) : least;
      }
    }
    return cells;
  }

  /** The measured ranges of some scans. */
  async #ranges(first: number, stop: number): Promise<Float32Array> {
    const found = new Float32Array((stop - first) * this.#rows);
    let scan = 0;
    for (const number of this.#segments.numbers) {
      const count = this.#seen.get(number)?.times.length ?? 0;
      if (scan < stop && scan + count > first) {
        const scans = this.#scansOf(await this.#segments.read(number));
        for (const [i, { ranges }] of scans.entries()) {
          if (scan + i >= first && scan + i < stop) found.set(ranges, (scan + i - first) * this.#rows);
        }
      }
      scan += count;
    }
    return found;
  }

  #scansOf(message: SegmentMessage): TimedRanges[] {
    return this.#segments.framesOf(message, this.#track).map(({ time, bytes }) => {
      const reader = new Reader(bytes);
      reader.bytes(HEAD - GEOMETRY);
      const [angleMin, angleIncrement] = [reader.float64(), reader.float64()];
      reader.bytes(LIMITS);
      const count = reader.float64();
      return { time, ranges: onRays(reader.float32s(count), { angleMin, angleIncrement, count }, this.#sweep) };
    });
  }

  #pack(
    facts: object,
    { cells, starts, ends, level, first }: Part,
    others: Map<string, Numbers> = new Map(),
  ): DataView {
    const arrays = new Map<string, Numbers>([...others, ["starts", starts], ["ends", ends], ["cells", cells]]);
    const listed = [...arrays].map(([name, array]) => [name, KINDS[array.BYTES_PER_ELEMENT], array.length]);
    const text = JSON.stringify({ ...facts, level, first, ray_step: this.#rayStep, arrays: listed });
    return packed(new TextEncoder().encode(text), [...arrays.values()]);
  }
}

const KINDS: Record<number, string> = { 8: "f8", 4: "f4", 2: "u2" };

function packed(text: Uint8Array, arrays: Numbers[]): DataView {
  const size = arrays.reduce((sum, { byteLength }) => sum + byteLength, 4 + text.length);
  const bytes = new Uint8Array(size);
  const view = new DataView(bytes.buffer);
  view.setUint32(0, text.length, true);
  bytes.set(text, 4);
  let at = 4 + text.length;
  for (const { buffer, byteOffset, byteLength } of arrays) {
    bytes.set(new Uint8Array(buffer, byteOffset, byteLength), at);
    at += byteLength;
  }
  return view;
}
