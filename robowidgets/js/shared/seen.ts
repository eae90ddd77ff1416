import { on, onAbort } from "./events.ts";

/** Milliseconds between two calls while an element is visible. */
const BEAT_MS = 10_000;

/**
 * Calls a function when an element becomes visible, every ten seconds from then on, and when it is no longer visible:
 * it is scrolled away or folded, or the page is hidden. It does not detect a closed page: the receiver of the beats has
 * to notice that they stop.
 */
export function watchSeen(element: HTMLElement, onBeat: (isSeen: boolean) => void, signal: AbortSignal): void {
  let isOnScreen = false;
  let wasSeen = false;
  const tell = () => {
    const isSeen = isOnScreen && document.visibilityState === "visible";
    if (!isSeen && !wasSeen) return;
    wasSeen = isSeen;
    onBeat(isSeen);
  };
  const observer = new IntersectionObserver((entries) => {
    isOnScreen = entries.at(-1)?.isIntersecting ?? false;
    tell();
  });
  observer.observe(element);
  on(document, "visibilitychange", tell, signal);
  const timer = setInterval(tell, BEAT_MS);
  // Python notices by itself that the beats stop: after the model is closed, nothing can be sent.
  onAbort(signal, () => {
    observer.disconnect();
    clearInterval(timer);
  });
}
