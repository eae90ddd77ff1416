import { onAbort } from "./events.ts";

/** Between two texts that follow the samples. Nobody reads faster, and laying out text takes longer than drawing dots. */
export const READING_MS = 100;

/** Draws once per animation frame, however often it is asked to. */
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

/** Calls at once, and again after `ms` at the earliest; who asked meanwhile is heard then. */
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
