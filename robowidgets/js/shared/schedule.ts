import { onAbort } from "./events.ts";

/** Between two updates of text. People read no faster, and laying out text is slower than drawing dots. */
export const READING_MS = 100;

/** Draws at most once per animation frame. */
export function perAnimationFrame(draw: () => void, signal: AbortSignal): () => void {
  let pending = 0;
  onAbort(signal, () => cancelAnimationFrame(pending));
  return () => {
    if (pending || signal.aborted) return;
    pending = requestAnimationFrame(() => {
      pending = 0;
      draw();
    });
  };
}

/** Calls at once, then at most once per `ms`; calls in between are merged into one at the end of the interval. */
export function throttle(call: () => void, ms: number, signal: AbortSignal): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  let asked = false;
  onAbort(signal, () => clearTimeout(timer));
  const run = () => {
    asked = false;
    timer = setTimeout(() => {
      timer = undefined;
      if (asked) run();
    }, ms);
    call();
  };
  return () => {
    asked = true;
    if (timer === undefined && !signal.aborted) run();
  };
}
