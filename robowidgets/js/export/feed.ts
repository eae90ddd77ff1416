import { decodeFrames, isNew, type TimedFrame } from "../player/segments.ts";
import type { SegmentMessage } from "../player/traits.ts";
import type { PageModel } from "./model.ts";
import { readPart } from "./parts.ts";
import { Taker } from "./taker.ts";
import { type PackedTracks, unpackTracks } from "./tracks.ts";

/** Most bytes of segments that a player keeps; those farthest from the time on show are dropped first. */
const KEPT_BYTES = 256e6;
/** Factor on the distance of segments that lie before the time on show: playing moves away from them. */
const BEHIND = 3;

/** The segments that are in the page, packed. */
export class Segments {
  readonly #elements: HTMLElement[];
  readonly #listeners: ((message: SegmentMessage) => void)[] = [];
  readonly #first: number;
  readonly #seconds: number;
  readonly #begin: number;

  /**
   * @param seconds the length of each
   * @param begin the time at which the first one begins, which may lie within it
   */
  constructor(elements: HTMLElement[], seconds: number, begin: number) {
    this.#elements = elements;
    this.#seconds = seconds;
    this.#begin = begin;
    this.#first = Math.floor(begin / seconds);
  }

  get numbers(): number[] {
    return this.#elements.map((_, i) => this.#first + i);
  }

  /** The frames of a track of a segment, without the earlier frame with which each track begins. */
  framesOf({ segment, tracks }: SegmentMessage, track: number): TimedFrame[] {
    const bytes = tracks[track];
    const [held, ...frames] = bytes ? decodeFrames(bytes) : [];
    const begin = Math.max(this.#begin, segment * this.#seconds);
    return held && held.time >= begin && held.time !== frames[0]?.time ? [held, ...frames] : frames;
  }

  /** The frames of a track of all segments with which a new sample came; see `isNew`. */
  async samplesOf(track: number, role?: string): Promise<TimedFrame[]> {
    const frames: TimedFrame[] = [];
    for (const number of this.numbers) {
      const message = await this.read(number);
      const abouts = message.abouts[track];
      frames.push(...this.framesOf(message, track).filter(({ about }) => isNew(abouts?.[about], role)));
    }
    return frames;
  }

  /** Calls back with each segment that is read. */
  listen(listener: (message: SegmentMessage) => void): void {
    this.#listeners.push(listener);
  }

  /** A segment as Python's player sends it. */
  async read(number: number): Promise<SegmentMessage> {
    const element = this.#elements[number - this.#first];
    if (!element) throw new Error(`segment ${number} is not in this page`);
    const { facts, bytes } = await readPart<PackedTracks & { segment: number }>(element.textContent);
    const tracks = unpackTracks(facts, new Taker(bytes));
    const abouts = facts.tracks.map((track) => track.abouts);
    const message: SegmentMessage = { segment: facts.segment, drop: [], abouts, tracks };
    for (const listener of this.#listeners) listener(message);
    return message;
  }
}

/**
 * Gives a player its segments, as Python does in a notebook: first the one on show, then the others, the nearest first.
 */
export class Feed {
  readonly #player: PageModel;
  readonly #segments: Segments;
  /** Bytes of each segment that the player has. */
  readonly #given = new Map<number, number>();
  readonly #most: number;
  #here: number;
  #isBusy = false;

  /** @param most bytes of segments that the player may keep */
  constructor(player: PageModel, segments: Segments, most = KEPT_BYTES) {
    this.#player = player;
    this.#segments = segments;
    this.#most = most;
    this.#here = player.get("time");
    player.on("change:time", () => this.#goTo(player.get("time")));
    player.on("sent", (content) => {
      const { pointed } = content as { pointed?: number };
      if (pointed !== undefined) this.#goTo(pointed);
    });
  }

  /** Gives all segments that the player may keep. */
  async run(): Promise<void> {
    if (this.#isBusy) return;
    this.#isBusy = true;
    for (let next = this.#next(); next !== undefined; next = this.#next()) {
      const { tracks, ...message } = await this.#segments.read(next);
      const size = tracks.reduce((sum, { byteLength }) => sum + byteLength, 0);
      const drop = this.#makeRoom(size);
      this.#given.set(next, size);
      this.#player.fire("msg:custom", { ...message, drop }, tracks);
    }
    this.#isBusy = false;
  }

  #goTo(time: number): void {
    this.#here = time;
    this.run();
  }

  /** The nearest segment that the player lacks; undefined if it has all that it may keep. */
  #next(): number | undefined {
    const lacking = this.#segments.numbers.filter((number) => !this.#given.has(number));
    const nearest = this.#farthest(lacking, -1);
    const farthest = this.#farthest([...this.#given.keys()]);
    if (nearest === undefined || farthest === undefined) return nearest;
    const hasRoom = this.#bytes + Math.max(...this.#given.values()) <= this.#most;
    return hasRoom || this.#distance(nearest) < this.#distance(farthest) ? nearest : undefined;
  }

  /** The farthest of some segments, or the nearest if the sign is -1. */
  #farthest(numbers: number[], sign = 1): number | undefined {
    return numbers.sort((a, b) => sign * (this.#distance(b) - this.#distance(a)))[0];
  }

  #distance(number: number): number {
    const apart = number - Math.floor(this.#here / this.#player.get("_segment"));
    return apart < 0 ? -BEHIND * apart : apart;
  }

  get #bytes(): number {
    return [...this.#given.values()].reduce((sum, bytes) => sum + bytes, 0);
  }

  /** Forgets the farthest segments until there is room for some bytes, and returns their numbers. */
  #makeRoom(size: number): number[] {
    const dropped: number[] = [];
    while (this.#given.size && this.#bytes + size > this.#most) {
      const farthest = this.#farthest([...this.#given.keys()]) as number;
      this.#given.delete(farthest);
      dropped.push(farthest);
    }
    return dropped;
  }
}
