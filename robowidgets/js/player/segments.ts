import { firstWhere } from "../shared/search.ts";
import type { About } from "../shared/traits.ts";

/** A frame that one widget shows from a time on. */
export interface TimedFrame {
  /** Seconds from the start of the recording. */
  time: number;
  /** Index of its facts from Python, in its track. */
  about: number;
  bytes: DataView;
}

/** The frames of one widget in one segment; the first holds at the start of the segment, however old it is. */
export interface Track {
  frames: TimedFrame[];
  abouts: Record<string, unknown>[];
}

/** A frame that a widget shows, with its track. */
export interface Shown {
  track: Track;
  frame: TimedFrame;
}

/**
 * Returns true if a frame has a new sample, by its texts.
 *
 * @param role the role of the sample; without one, any sample counts
 */
export function isNew(about: About = {}, role?: string): boolean {
  if (!about.new) return true;
  return role ? about.new.includes(role) : about.new.length > 0;
}

const ROW = 3;
/** Seconds; a time at the end of a segment belongs to the next one. */
const JUST_BEFORE = 1e-6;

/** Reads the frames of a track; docs/developers/frames.md has the layout. */
export function decodeFrames(bytes: DataView): TimedFrame[] {
  const count = bytes.getFloat64(0, true);
  const number = (i: number) => bytes.getFloat64(8 * (1 + i), true);
  const base = bytes.byteOffset + 8 * (1 + ROW * count);
  return Array.from({ length: count }, (_, i) => {
    const start = i ? number(ROW * i - 1) : 0;
    const end = number(ROW * i + 2);
    const copy = new DataView(bytes.buffer.slice(base + start, base + end));
    return { time: number(ROW * i), about: number(ROW * i + 1), bytes: copy };
  });
}

/** The segments of a recording that the page has, each as long as the others. */
export class Segments {
  readonly #seconds: number;
  readonly #tracks = new Map<number, Track[]>();

  /** @param seconds the length of one */
  constructor(seconds: number) {
    this.#seconds = seconds;
  }

  put(index: number, tracks: Track[]): void {
    this.#tracks.set(index, tracks);
  }

  clear(): void {
    this.#tracks.clear();
  }

  drop(indices: number[]): void {
    for (const index of indices) this.#tracks.delete(index);
  }

  /** From the start of the first segment to just before the end of the last; null without any. */
  get span(): [number, number] | null {
    const numbers = [...this.#tracks.keys()];
    if (!numbers.length) return null;
    return [Math.min(...numbers) * this.#seconds, (Math.max(...numbers) + 1) * this.#seconds - JUST_BEFORE];
  }

  has(time: number): boolean {
    return this.#tracks.has(this.indexOf(time));
  }

  /** The frames of all widgets at a time; null if that segment is missing. */
  at(time: number): Shown[] | null {
    const tracks = this.#tracks.get(this.indexOf(time));
    if (!tracks) return null;
    return tracks.map((track) => {
      const next = firstWhere(track.frames, (frame) => frame.time > time);
      return { track, frame: track.frames[Math.max(0, next - 1)] as TimedFrame };
    });
  }

  /** The last frames of one widget up to a time, oldest first: at most so many, within the segments of the page. */
  upTo(of: number, time: number, count: number): Shown[] {
    let found: Shown[] = [];
    for (let index = this.indexOf(time); found.length < count; index--) {
      const track = this.#tracks.get(index)?.[of];
      if (!track) break;
      const frames = track.frames.filter((frame) => frame.time >= index * this.#seconds && frame.time <= time);
      found = [...frames.map((frame) => ({ track, frame })), ...found];
    }
    return found.slice(-count);
  }

  /**
   * The time of the next or the previous new sample of one widget.
   *
   * @returns null if the segment that contains it is missing
   */
  neighbour(of: number, time: number, direction: -1 | 1, duration: number): number | null {
    for (let index = this.indexOf(time); index >= 0 && index * this.#seconds <= duration; index += direction) {
      const track = this.#tracks.get(index)?.[of];
      if (!track) return null;
      const start = index * this.#seconds;
      const frames = track.frames.filter(({ time, about }) => time >= start && isNew(track.abouts[about]));
      const times = frames.map((frame) => frame.time);
      const found = direction > 0 ? times.find((t) => t > time) : times.filter((t) => t < time).at(-1);
      if (found !== undefined) return found;
    }
    return time;
  }

  /** The number of the segment in which a time lies. */
  indexOf(time: number): number {
    return Math.floor(time / this.#seconds);
  }
}
