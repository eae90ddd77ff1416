import { on } from "./events.ts";

const SCROLL_PAUSE_MS = 250;

/**
 * Passes on wheel events, unless the wheel was already scrolling the page when the picture moved under the pointer.
 *
 * @param onWheel returns true if it used the event; else the page scrolls, unless events just before were used
 */
export function watchWheel(element: HTMLElement, onWheel: (event: WheelEvent) => boolean, signal: AbortSignal): void {
  let pointed = false;
  let scrolled = -Infinity;
  let used = -Infinity;
  const onMove = (event: PointerEvent) => {
    pointed ||= event.movementX !== 0 || event.movementY !== 0;
  };
  const onDown = () => {
    pointed = true;
    scrolled = -Infinity;
  };
  const onLeave = () => {
    pointed = false;
  };
  const onPage = (event: WheelEvent) => {
    if (!element.contains(event.target as Node)) scrolled = event.timeStamp;
  };
  const onTurn = (event: WheelEvent) => {
    if (!pointed || event.timeStamp - scrolled < SCROLL_PAUSE_MS) {
      scrolled = event.timeStamp;
      return;
    }
    if (!onWheel(event) && event.timeStamp - used > SCROLL_PAUSE_MS) return;
    used = event.timeStamp;
    event.preventDefault();
  };
  on(element, "pointermove", onMove, signal);
  on(element, "pointerdown", onDown, signal);
  on(element, "pointerleave", onLeave, signal);
  on(window, "wheel", onPage, signal, { passive: true, capture: true });
  on(element, "wheel", onTurn, signal, { passive: false });
}
