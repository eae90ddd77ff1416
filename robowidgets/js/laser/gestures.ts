import type { Point } from "./projection.ts";

/** What a person can do to the picture. */
export interface Gestures {
  onHover(point: Point | null): void;
  onPick(point: Point): void;
  /** Walks to another ray: "next", "previous", "first", "last" or "none". */
  onWalk(to: string): void;
  onZoom(direction: -1 | 1): void;
  /** Whether there is anything left to zoom; else the wheel is the page's. */
  canZoom(direction: -1 | 1): boolean;
}

const WALK: Record<string, string> = {
  ArrowRight: "next",
  ArrowUp: "next",
  ArrowLeft: "previous",
  ArrowDown: "previous",
  Home: "first",
  End: "last",
  Escape: "none",
};
const ZOOM: Record<string, -1 | 1> = { "+": -1, "=": -1, "-": 1, _: 1 };
const SCROLL_PAUSE_MS = 250;
const WHEEL_STEP = 40;

type Listen = <K extends keyof HTMLElementEventMap>(type: K, callback: (event: HTMLElementEventMap[K]) => void) => void;

export function watchGestures(element: HTMLElement, gestures: Gestures, signal: AbortSignal): void {
  const on: Listen = (type, callback) => element.addEventListener(type, callback, { signal, passive: false });
  const toPoint = (event: MouseEvent): Point => {
    const { left, top } = element.getBoundingClientRect();
    return { x: event.clientX - left, y: event.clientY - top };
  };
  on("pointermove", (event) => {
    if (event.pointerType !== "touch") gestures.onHover(toPoint(event));
  });
  on("pointerleave", () => gestures.onHover(null));
  on("click", (event) => gestures.onPick(toPoint(event)));
  const onKey = (event: KeyboardEvent) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const [walk, zoom] = [WALK[event.key], ZOOM[event.key]];
    if (walk) gestures.onWalk(walk);
    else if (zoom) gestures.onZoom(zoom);
    else return;
    event.preventDefault();
  };
  // Who froze the picture by its button walks on without a click into the picture.
  element.parentElement?.addEventListener("keydown", onKey, { signal });
  watchWheel(on, element, gestures, signal);
}

/** The wheel zooms, unless it was already scrolling the page when the picture came under the pointer. */
function watchWheel(on: Listen, element: HTMLElement, gestures: Gestures, signal: AbortSignal): void {
  let pointed = false;
  let scrolled = -Infinity;
  let zoomed = -Infinity;
  let turned = 0;
  on("pointermove", (event) => {
    pointed ||= event.movementX !== 0 || event.movementY !== 0;
  });
  on("pointerdown", () => {
    pointed = true;
    scrolled = -Infinity;
  });
  on("pointerleave", () => {
    pointed = false;
  });
  window.addEventListener(
    "wheel",
    (event) => {
      if (!element.contains(event.target as Node)) scrolled = event.timeStamp;
    },
    { signal, passive: true, capture: true },
  );
  on("wheel", (event) => {
    if (!pointed || event.timeStamp - scrolled < SCROLL_PAUSE_MS) {
      scrolled = event.timeStamp;
      return;
    }
    const direction = event.deltaY < 0 ? -1 : 1;
    if (!gestures.canZoom(direction) && event.timeStamp - zoomed > SCROLL_PAUSE_MS) return;
    zoomed = event.timeStamp;
    event.preventDefault();
    turned += event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 20 : 1);
    if (Math.abs(turned) < WHEEL_STEP) return;
    gestures.onZoom(direction);
    turned = 0;
  });
}
