import type { Point } from "../shared/box.ts";
import { isDragged, pointIn, setTip } from "../shared/dom.ts";
import { isOver, isPlain, on } from "../shared/events.ts";
import { watchZoom, ZOOM_KEYS, type Zoom } from "../shared/zoom.ts";
import type { Drag, Layer } from "./layer.ts";

/**
 * Offers each action of the user on the picture to the layers, from the last of the list, until one takes it.
 *
 * @param zoom null for an element that takes neither the wheel nor keys, apart from Escape
 * @param toPoint the place in the picture that an event on the element means
 */
export function watchGestures(
  element: HTMLElement,
  layers: Layer[],
  zoom: Zoom | null,
  signal: AbortSignal,
  toPoint = (event: MouseEvent): Point => pointIn(element, event),
): void {
  const fromTop = [...layers].reverse();
  const hover = (point: Point | null) => {
    let left = point;
    for (const layer of fromTop) if (layer.onHover?.(left)) left = null;
    setTip(element, (point && fromTop.map((layer) => layer.tip?.(point)).find(Boolean)) || "");
  };
  const click = (point: Point) => fromTop.some((layer) => layer.onClick?.(point));
  const presses = watchPresses(element, fromTop, toPoint, click, () => hover(null), signal);
  const onMove = (event: PointerEvent) => {
    if (event.pointerType !== "touch" && !presses.moved) hover(isOver(event) ? null : toPoint(event));
  };
  on(element, "pointermove", onMove, signal);
  on(element, "pointerleave", () => hover(null), signal);
  const onClick = (event: MouseEvent) => {
    if (!presses.takeClick() && !isOver(event)) click(toPoint(event));
  };
  on(element, "click", onClick, signal);
  const { parentElement } = element;
  if (!zoom) {
    const onEscape = ({ key }: KeyboardEvent) => key === "Escape" && presses.cancel();
    if (parentElement) on(parentElement, "keydown", onEscape, signal);
    return;
  }
  const onKey = (event: KeyboardEvent) => {
    // Some keyboards have brackets on AltGr, which counts as Ctrl and Alt.
    if (!isPlain(event) && !event.getModifierState?.("AltGraph")) return;
    const direction = ZOOM_KEYS[event.key];
    if (event.key === "Escape" && presses.cancel()) event.preventDefault();
    else if (event.key === "Tab" && event.target === element && walk(fromTop, event.shiftKey)) event.preventDefault();
    else if (fromTop.some((layer) => layer.onKey?.(event))) event.preventDefault();
    else if (direction) {
      zoom.onZoom(direction);
      event.preventDefault();
    }
  };
  // On the card: after a click on the freeze button, arrow keys work without a click into the picture.
  on(parentElement ?? element, "keydown", onKey, signal);
  watchZoom(element, zoom, signal);
}

/** Picks the next or the previous stop; returns false beyond the last, where Tab leads to the controls of the card. */
export function walk(layers: Pick<Layer, "stops">[], isBack: boolean): boolean {
  const all = layers.flatMap(({ stops }) => stops?.names.map((name) => ({ stops, name })) ?? []);
  if (isBack) all.reverse();
  const at = all.findIndex(({ stops, name }) => stops.picked === name);
  const next = all[at + 1];
  if (at >= 0 && all[at]?.stops !== next?.stops) all[at]?.stops.pick("");
  next?.stops.pick(next.name);
  return next !== undefined;
}

/** A press that a layer has taken. */
interface Press {
  id: number;
  drag: Drag;
  start: Point;
  moved: boolean;
}

/** Presses of the main button or of one finger that a layer has taken. */
function watchPresses(
  element: HTMLElement,
  fromTop: Layer[],
  toPoint: (event: MouseEvent) => Point,
  click: (point: Point) => void,
  leave: () => void,
  signal: AbortSignal,
) {
  let press: Press | null = null;
  let swallows = false;
  const finish = (end: "end" | "cancel"): boolean => {
    const ended = press;
    press = null;
    ended?.drag[end]();
    return ended !== null;
  };
  const onDown = (event: PointerEvent) => {
    swallows = false;
    if (press || event.button || !event.isPrimary || isOver(event)) return;
    const start = toPoint(event);
    for (const layer of fromTop) {
      const drag = layer.onPress?.(start, event.pointerType === "touch");
      if (!drag) continue;
      press = { id: event.pointerId, drag, start, moved: false };
      element.setPointerCapture(event.pointerId);
      return;
    }
  };
  const onMove = (event: PointerEvent) => {
    if (press?.id !== event.pointerId) return;
    const point = toPoint(event);
    if (!press.moved && isDragged(press.start, point)) {
      press.moved = true;
      leave();
    }
    if (press.moved) press.drag.move(point);
  };
  const onUp = (event: PointerEvent) => {
    if (press?.id !== event.pointerId) return;
    const { moved, start } = press;
    swallows = moved;
    finish(moved ? "end" : "cancel");
    // A touch that a layer has taken makes no click.
    if (!moved && event.pointerType === "touch") click(start);
  };
  const onCancel = (event: PointerEvent) => {
    if (press?.id === event.pointerId) finish("cancel");
  };
  // Else the browser would scroll the page instead.
  const onTouch = (event: TouchEvent) => {
    if (press && event.cancelable) event.preventDefault();
  };
  on(element, "pointerdown", onDown, signal);
  on(element, "pointermove", onMove, signal);
  on(element, "pointerup", onUp, signal);
  on(element, "pointercancel", onCancel, signal);
  on(element, "touchstart", onTouch, signal, { passive: false });
  return {
    get moved() {
      return press?.moved ?? false;
    },
    /** Cancels a drag; returns true if there was one. */
    cancel: () => {
      swallows ||= press?.moved ?? false;
      return finish("cancel");
    },
    /** Returns true if the click that follows now ends a drag. */
    takeClick: () => {
      const taken = swallows;
      swallows = false;
      return taken;
    },
  };
}
