import { toBytes } from "./bytes.ts";
import { onAbort } from "./events.ts";
import { lacksKernel, type Model, newName, onMessage } from "./model.ts";
import { sequenceOf } from "./stream.ts";
import type { LargeTraits } from "./traits.ts";

/**
 * Tells Python what this page has drawn of the frames of one model, so that the next one goes; its views share it. What
 * is hidden is not drawn, and gets no more.
 */
export class Credit {
  readonly #model: Model<LargeTraits>;
  readonly #page = newName();
  /** Undefined: nothing yet, not even that there is no frame. */
  #drawn: DataView | null | undefined;

  constructor(model: Model<LargeTraits>, signal: AbortSignal) {
    this.#model = model;
    let frame = 0;
    onAbort(signal, () => cancelAnimationFrame(frame));
    const onAsked = ({ asks }: { asks?: number }) => {
      if (asks === undefined) return;
      cancelAnimationFrame(frame);
      // A hidden page answers when it is seen again.
      frame = requestAnimationFrame(() => this.#answer(asks));
    };
    onMessage(model, onAsked, signal);
  }

  /** The frame that came last, to draw and to give to `drawn` then. */
  get newest(): DataView | null {
    return toBytes(this.#model.get("_frame"));
  }

  /** Tells that a frame is on the screen, or that what is there instead, as while frozen, was drawn after it came. */
  drawn(bytes: DataView | null = this.newest): void {
    if (bytes === this.#drawn) return;
    this.#drawn = bytes;
    this.#tell({});
  }

  #answer(asks: number): void {
    this.#tell(sequenceOf(this.newest) < asks ? { lacks: asks } : {});
  }

  #tell(more: { lacks?: number }): void {
    const model = this.#model;
    if (!model.get("_answers") || lacksKernel(model)) return;
    model.send({ drawn: sequenceOf(this.#drawn ?? null), page: this.#page, ...more });
  }
}
