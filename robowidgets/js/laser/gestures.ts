import { isPlain, on } from "../shared/events.ts";
import { watchWheel } from "../shared/wheel.ts";
import type { Point } from "./projection.ts";

/** What a person can do to the picture. */
export interface Gestures {
  onHover(point: Point | null): void;
  onPick(point: Point): void;
  /** Walks to another ray: "next", "previous", "forth", "back" (both far), "first", "last", "nearest" or "none". */
  onWalk(to: string): void;
  onZoom(direction: -1 | 1): void;
  /** Whether it can zoom further; if not, the wheel scrolls the page. */
  canZoom(direction: -1 | 1): boolean;
}

const WALK: Record<string, string> = {
  ArrowRight: "next",
  ArrowUp: "next",
  ArrowLeft: "previous",
  ArrowDown: "previous",
  PageUp: "forth",
  PageDown: "back",
  m: "nearest",
  Home: "first",
  End: "last",
  Escape: "none",
};
const ZOOM: Record<string, -1 | 1> = { "+": -1, "=": -1, "-": 1, _: 1 };
const WHEEL_STEP = 40;

export function watchGestures(element: HTMLElement, gestures: Gestures, signal: AbortSignal): void {
  const toPoint = (event: MouseEvent): Point => {
    const { left, top } = element.getBoundingClientRect();
    return { x: event.clientX - left, y: event.clientY - top };
  };
  const onMove = (event: PointerEvent) => {
    if (event.pointerType !== "touch") gestures.onHover(toPoint(event));
  };
  on(element, "pointermove", onMove, signal);
  on(element, "pointerleave", () => gestures.onHover(null), signal);
  on(element, "click", (event) => gestures.onPick(toPoint(event)), signal);
  const onKey = (event: KeyboardEvent) => {
    if (!isPlain(event)) return;
    const [walk, zoom] = [WALK[event.key], ZOOM[event.key]];
    if (walk) gestures.onWalk(walk);
    else if (zoom) gestures.onZoom(zoom);
    else return;
    event.preventDefault();
  };
  // On the card: after a click on the freeze button, arrow keys work without a click into the picture.
  on(element.parentElement ?? element, "keydown", onKey, signal);
  let turned = 0;
  const onWheel = (event: WheelEvent): boolean => {
    const direction = event.deltaY < 0 ? -1 : 1;
    turned += event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 20 : 1);
    if (Math.abs(turned) >= WHEEL_STEP) {
      gestures.onZoom(direction);
      turned = 0;
    }
    return gestures.canZoom(direction);
  };
  watchWheel(element, onWheel, signal);
}
