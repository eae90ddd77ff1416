/** What one widget shows from a time on. */
export interface Still {
  /** Seconds from the start of the recording. */
  time: number;
  /** Index of what is said of it, in its track. */
  about: number;
  frame: DataView;
}

/** The stills of one widget in one stretch; the first holds at the start of the stretch, however old it is. */
export interface Track {
  stills: Still[];
  abouts: Record<string, unknown>[];
}

const ROW = 3;

/** Reads the stills of a track: how many, then time, about and end of each frame as float64, then the frames. */
export function decodeStills(bytes: DataView): Still[] {
  const count = bytes.getFloat64(0, true);
  const number = (i: number) => bytes.getFloat64(8 * (1 + i), true);
  const base = bytes.byteOffset + 8 * (1 + ROW * count);
  return Array.from({ length: count }, (_, i) => {
    const start = i ? number(ROW * i - 1) : 0;
    const frame = new DataView(bytes.buffer.slice(base + start, base + number(ROW * i + 2)));
    return { time: number(ROW * i), about: number(ROW * i + 1), frame };
  });
}

/** The index of the last still at a time or before it. */
function indexAt(stills: Still[], time: number): number {
  let [low, high] = [0, stills.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((stills[middle] as Still).time <= time) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

/** The stretches of a recording that the page has, each as long as the others. */
export class Stretches {
  readonly #seconds: number;
  readonly #tracks = new Map<number, Track[]>();

  /** @param seconds the length of one */
  constructor(seconds: number) {
    this.#seconds = seconds;
  }

  put(index: number, tracks: Track[]): void {
    this.#tracks.set(index, tracks);
  }

  drop(indices: number[]): void {
    for (const index of indices) this.#tracks.delete(index);
  }

  has(time: number): boolean {
    return this.#tracks.has(this.indexOf(time));
  }

  /** What each widget shows at a time; null where that stretch is not here. */
  at(time: number): { track: Track; still: Still }[] | null {
    const tracks = this.#tracks.get(this.indexOf(time));
    if (!tracks) return null;
    return tracks.map((track) => ({ track, still: track.stills[Math.max(0, indexAt(track.stills, time))] as Still }));
  }

  /**
   * The time of the next still of one widget, or of the one before.
   * @returns null where the stretch that must hold it is not here
   */
  neighbour(of: number, time: number, direction: -1 | 1, duration: number): number | null {
    for (let index = this.indexOf(time); index >= 0 && index * this.#seconds <= duration; index += direction) {
      const stills = this.#tracks.get(index)?.[of]?.stills;
      if (!stills) return null;
      const start = index * this.#seconds;
      const times = stills.map((still) => still.time).filter((t) => t >= start);
      const found = direction > 0 ? times.find((t) => t > time) : times.filter((t) => t < time).at(-1);
      if (found !== undefined) return found;
    }
    return time;
  }

  /** The number of the stretch in which a time lies. */
  indexOf(time: number): number {
    return Math.floor(time / this.#seconds);
  }
}
