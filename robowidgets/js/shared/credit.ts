import { toBytes } from "./bytes.ts";
import { onAbort } from "./events.ts";
import { lacksKernel, type Model, newName, onMessage } from "./model.ts";
import { sequenceOf } from "./stream.ts";
import type { LargeTraits } from "./traits.ts";

/**
 * Reports to Python which frames of one model this page has drawn, so that the next one is sent; its views share it. A
 * hidden view is not drawn, and gets no more frames.
 */
export class Credit {
  readonly #model: Model<LargeTraits>;
  readonly #page = newName();
  /** Undefined before the first report, also of a missing frame. */
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

  /** The newest frame, to draw and then to give to `drawn`. */
  get newest(): DataView | null {
    return toBytes(this.#model.get("_frame"));
  }

  /**
   * Reports that a frame is on the screen, or that the picture on show instead, such as a frozen one, was drawn after
   * it arrived.
   */
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
