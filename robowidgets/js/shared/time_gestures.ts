import type { Point } from "./box.ts";
import { isDragged, pointIn } from "./dom.ts";
import { isPlain, on as listen } from "./events.ts";
import { watchWheel } from "./wheel.ts";

/** Actions of the user on the picture. */
interface Gestures {
  onHover(point: Point | null): void;
  /** A press that may become a click. */
  onPress(point: Point): void;
  onPick(point: Point): void;
  /** A span being dragged, with rays if `rays`; `done` when the button was released. */
  onSelect(from: Point, to: Point, rays: boolean, done: boolean): void;
  /** The drag ends without a selection: the earlier selection stays. */
  onCancel(): void;
  onPan(pixels: number): void;
  /** A factor below 1 zooms in; around the time cursor without a point. */
  onZoom(factor: number, point: Point | null): void;
  canZoom(factor: number): boolean;
  onReset(): void;
  onClear(): void;
  /** Steps by so many scans, or to either end. */
  onStep(by: number): void;
  /** Goes to the next or the previous mark. */
  onMark(direction: -1 | 1): void;
}

const STEPS: Record<string, number> = { ArrowLeft: -1, ArrowRight: 1, Home: -Infinity, End: Infinity };
const ZOOMS: Record<string, number> = { "+": 0.5, "=": 0.5, "-": 2, _: 2 };
const MANY = 10;

type Listen = <K extends keyof HTMLElementEventMap>(type: K, callback: (event: HTMLElementEventMap[K]) => void) => void;

export function watchGestures(element: HTMLElement, gestures: Gestures, signal: AbortSignal): void {
  const on: Listen = (type, callback) => listen(element, type, callback, signal);
  const toPoint = (event: MouseEvent): Point => pointIn(element, event);
  const cancelDrag = watchDrag(on, element, toPoint, gestures);
  on("pointerleave", () => gestures.onHover(null));
  on("dblclick", () => gestures.onReset());
  on("keydown", (event) => {
    if (!isPlain(event)) return;
    const [step, zoom] = [STEPS[event.key], ZOOMS[event.key]];
    if (step !== undefined) gestures.onStep(event.shiftKey ? MANY * step : step);
    else if (zoom !== undefined) gestures.onZoom(zoom, null);
    else if (event.key === "n" || event.key === "p") gestures.onMark(event.key === "n" ? 1 : -1);
    else if (event.key === "0") gestures.onReset();
    else if (event.key === "Escape") {
      if (!cancelDrag()) gestures.onClear();
    } else return;
    event.preventDefault();
  });
  const onWheel = (event: WheelEvent): boolean => {
    const across = event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY);
    const unit = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 20 : 1;
    if (across) {
      gestures.onPan((event.deltaX || event.deltaY) * unit);
      return true;
    }
    const factor = Math.exp(Math.max(-1, Math.min(1, (event.deltaY * unit) / 400)));
    if (!gestures.canZoom(factor)) return false;
    gestures.onZoom(factor, toPoint(event));
    return true;
  };
  watchWheel(element, onWheel, signal);
}

/**
 * A press that moves is a drag; one that does not move is a click. A second finger makes neither. Returns a function
 * that cancels, and that returns false if nothing is pressed.
 */
function watchDrag(
  on: Listen,
  element: HTMLElement,
  toPoint: (event: MouseEvent) => Point,
  gestures: Gestures,
): () => boolean {
  let from: Point | null = null;
  let last: Point = { x: 0, y: 0 };
  let kind: "select" | "rays" | "pan" | null = null;
  let id = 0;
  const cancel = (): boolean => {
    if (!from) return false;
    from = null;
    gestures.onCancel();
    return true;
  };
  on("pointerdown", (event) => {
    if (from || !event.isPrimary || event.button > 1 || (event.target as HTMLElement).closest("button")) return;
    from = last = toPoint(event);
    gestures.onPress(from);
    kind = null;
    id = event.pointerId;
    element.setPointerCapture(id);
  });
  on("pointermove", (event) => {
    const point = toPoint(event);
    if (!from) {
      if (event.pointerType !== "touch") gestures.onHover(point);
      return;
    }
    if (event.pointerId !== id) return;
    if (!kind) {
      if (!isDragged(from, point)) return;
      kind = event.altKey || event.buttons & 4 ? "pan" : event.shiftKey ? "rays" : "select";
      gestures.onHover(null);
    }
    if (kind === "pan") gestures.onPan(last.x - point.x);
    else gestures.onSelect(from, point, kind === "rays", false);
    last = point;
  });
  on("pointerup", (event) => {
    if (!from || event.pointerId !== id) return;
    const [start, point] = [from, toPoint(event)];
    from = null;
    if (!kind && event.button === 0) gestures.onPick(point);
    else if (kind !== "pan") gestures.onSelect(start, point, kind === "rays", true);
  });
  on("pointercancel", ({ pointerId }) => pointerId === id && cancel());
  return cancel;
}
