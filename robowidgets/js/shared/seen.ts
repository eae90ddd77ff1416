import { on, onAbort } from "./events.ts";

/** Between two calls that somebody still looks. */
const BEAT_MS = 10_000;

/**
 * Calls a function when somebody begins to see an element, every ten seconds from then on, and when nobody does any
 * more: it is scrolled away or folded, or the page is hidden. It does not hear that the page is gone: what takes the
 * beats has to miss them.
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
  // Python notices by itself that nobody says so any more: where the model is closed, nothing can be sent.
  onAbort(signal, () => {
    observer.disconnect();
    clearInterval(timer);
  });
}
