import { decodeScan, type Scan } from "../shared/frames/scan.ts";
import type { Model } from "../shared/model.ts";
import type { Stream } from "../shared/stream.ts";
import type { LaserTraits } from "./traits.ts";

/** A scan, and where its scanner was in the frame of odometry, if that is known. */
export interface PastScan {
  scan: Scan;
  pose: [x: number, y: number, yaw: number] | undefined;
}

/** The last scans up to the one on show, each decoded once. */
export class Past {
  readonly #model: Model<LaserTraits>;
  readonly #stream: Stream<Scan>;
  /** Of those that may be asked for, by their frames. */
  #decoded = new Map<DataView, Scan>();

  constructor(model: Model<LaserTraits>, stream: Stream<Scan>) {
    this.#model = model;
    this.#stream = stream;
  }

  /** How many scans before the one on show are behind it. */
  get trail(): number {
    return this.#model.get("trail");
  }

  /** Over how many scans the spread is drawn. */
  get spread(): number {
    return this.#model.get("spread");
  }

  /** At most so many scans, oldest first; the last is the one on show. */
  last(count: number): PastScan[] {
    const before = this.#decoded;
    const moments = this.#stream.last(Math.max(this.trail + 1, this.spread));
    this.#decoded = new Map(moments.map(({ bytes }) => [bytes, before.get(bytes) ?? decodeScan(bytes)]));
    return moments.slice(-count).map(({ bytes, about }) => {
      return { scan: this.#decoded.get(bytes) as Scan, pose: about.pose };
    });
  }
}
