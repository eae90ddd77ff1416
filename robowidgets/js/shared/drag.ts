import type { Point } from "./box.ts";
import { isDragged, pointIn } from "./dom.ts";
import { isOver, on } from "./events.ts";

/** A step of a drag, in pixels of the picture. */
export interface Step {
  from: Point;
  /** End of the previous step. */
  last: Point;
  at: Point;
  /** True if the pointer is released there. */
  ends: boolean;
}

/** Actions of a pointer over a picture whose drags are of some kinds. */
export interface Dragged<Kind extends string> {
  /** The place at which the pointer rests or moves; null outside of the picture. A finger does not point. */
  onPoint(at: Point | null): void;
  /** The kind of drag that a press begins once it moves; null for no drag. */
  startsAt(at: Point, event: PointerEvent): Kind | null;
  onDrag(kind: Kind, step: Step): void;
  /** A press of the main button that has not moved. */
  onTap(at: Point): void;
}

/** Passes on the actions of a pointer over a picture, but not over elements on top of it. */
export function watchDrags<Kind extends string>(
  picture: HTMLElement,
  dragged: Dragged<Kind>,
  signal: AbortSignal,
): void {
  let press: { id: number; kind: Kind; from: Point; last: Point } | null = null;
  let hasMoved = false;
  const onDown = (event: PointerEvent) => {
    [press, hasMoved] = [null, false];
    if (isOver(event)) return;
    const from = pointIn(picture, event);
    const kind = dragged.startsAt(from, event);
    if (kind) press = { id: event.pointerId, kind, from, last: from };
  };
  const onMove = (event: PointerEvent) => {
    const at = pointIn(picture, event);
    if (event.pointerType !== "touch") dragged.onPoint(isOver(event) ? null : at);
    if (press?.id !== event.pointerId || (!hasMoved && !isDragged(press.from, at))) return;
    if (!hasMoved) picture.setPointerCapture(event.pointerId);
    hasMoved = true;
    dragged.onDrag(press.kind, { from: press.from, last: press.last, at, ends: false });
    press.last = at;
  };
  const onEnd = (event: PointerEvent) => {
    if (press?.id !== event.pointerId) return;
    const { kind, from, last } = press;
    press = null;
    // A pointer that is cancelled, such as by a phone call, has no place.
    const at = event.type === "pointerup" ? pointIn(picture, event) : last;
    if (hasMoved) dragged.onDrag(kind, { from, last, at, ends: true });
  };
  on(picture, "pointerdown", onDown, signal);
  on(picture, "pointermove", onMove, signal);
  on(picture, "pointerleave", () => dragged.onPoint(null), signal);
  on(picture, "pointerup", onEnd, signal);
  on(picture, "pointercancel", onEnd, signal);
  on(picture, "click", (event) => !hasMoved && !isOver(event) && dragged.onTap(pointIn(picture, event)), signal);
}
