import type { Size } from "./box.ts";
import { onAbort } from "./events.ts";

/**
 * The size of an element with its borders at its last layout: reading it does not cause a layout. A hidden element
 * keeps its size.
 */
export class LaidOut implements Size {
  width: number;
  height: number;
  readonly #observer: ResizeObserver;

  /**
   * @param onResize called after layout, before the page is painted
   * @param guess the size before the first layout
   */
  constructor(onResize: () => void, signal: AbortSignal, guess: Size = { width: 0, height: 0 }) {
    this.width = guess.width;
    this.height = guess.height;
    this.#observer = new ResizeObserver(([entry]) => {
      const [size] = entry?.borderBoxSize ?? [];
      if (!size?.inlineSize) return;
      this.width = size.inlineSize;
      this.height = size.blockSize;
      onResize();
    });
    onAbort(signal, () => this.#observer.disconnect());
  }

  /** Follows another element instead of the previous one; returns itself. */
  of(element: Element): this {
    this.#observer.disconnect();
    this.#observer.observe(element);
    return this;
  }
}
