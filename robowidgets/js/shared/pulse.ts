import { onAbort } from "./events.ts";
import { toAge } from "./format.ts";
import { lacksKernel, type Model, NO_KERNEL, onChange } from "./model.ts";
import { KERNEL_SILENT_MS } from "./staleness.ts";

/** Milliseconds between two looks at the clock. */
const LOOK_MS = 250;

/**
 * Watches if Python still sends to a widget. A kernel that sleeps or hangs does not, nor does one that was restarted.
 */
export class Pulse<T> {
  readonly #model: Pick<Model<T>, "get" | "on" | "off">;
  readonly #isExpected: () => boolean;
  /** NaN in a page that never had a kernel: its contents are kept, not live. */
  #heard: number;
  #said = "";

  /**
   * @param names the traits, one of which Python sets every second
   * @param isExpected returns true while it does
   * @param tell called when the words change
   */
  constructor(
    model: Pick<Model<T>, "get" | "on" | "off">,
    names: readonly (keyof T & string)[],
    isExpected: () => boolean,
    tell: () => void,
    signal: AbortSignal,
  ) {
    this.#model = model;
    this.#isExpected = isExpected;
    this.#heard = lacksKernel(model) ? NaN : performance.now();
    onChange(model, names, () => (this.#heard = performance.now()), signal);
    const looks = setInterval(() => {
      if (this.words === this.#said) return;
      this.#said = this.words;
      tell();
    }, LOOK_MS);
    onAbort(signal, () => clearInterval(looks));
  }

  /** Milliseconds since the last message if one is missing; 0 while all is well. */
  get silence(): number {
    const silence = performance.now() - this.#heard;
    return this.#isExpected() && silence > (lacksKernel(this.#model) ? 0 : KERNEL_SILENT_MS) ? silence : 0;
  }

  /** The time for which Python has been silent, or that its kernel has ended; "" while all is well. */
  get words(): string {
    const { silence } = this;
    if (!silence) return "";
    return lacksKernel(this.#model) ? NO_KERNEL : `no word from the kernel for ${toAge(silence)}`;
  }
}
