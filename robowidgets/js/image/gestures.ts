import type { Point } from "../shared/box.ts";
import { isDragged, pointIn } from "../shared/dom.ts";
import { on } from "../shared/events.ts";

/** What a person does to a picture with a pointer. */
export interface ImageActs {
  onPoint(at: Point | null): void;
  onTap(at: Point): void;
  /** A part is marked; `isOver` once the pointer lets go. */
  onMark(from: Point, to: Point, isOver: boolean): void;
  onMove(dx: number, dy: number): void;
  /** Whether all of it is there, so that a finger scrolls the page. */
  readonly isWhole: boolean;
}

interface Drag {
  pointer: number;
  from: Point;
  last: Point;
  moves: boolean;
  hasMoved: boolean;
}

/** Has a drag mark a part of the picture; with Shift, with the middle button, or of a finger it moves the picture. */
export function watchImage(picture: HTMLElement, acts: ImageActs, signal: AbortSignal): void {
  let drag: Drag | null = null;
  let hasMoved = false;
  const isOver = ({ target }: Event) => target instanceof Element && target.closest(".rw-over") !== null;
  const onDown = (event: PointerEvent) => {
    hasMoved = false;
    const isTouch = event.pointerType === "touch";
    if (isOver(event) || event.button > 1 || (isTouch && acts.isWhole)) return;
    const from = pointIn(picture, event);
    const moves = isTouch || event.shiftKey || event.button === 1;
    if (event.button === 1) event.preventDefault();
    drag = { pointer: event.pointerId, from, last: from, moves, hasMoved: false };
  };
  const onMove = (event: PointerEvent) => {
    const at = pointIn(picture, event);
    if (event.pointerType !== "touch") acts.onPoint(isOver(event) && !drag ? null : at);
    if (!drag || event.pointerId !== drag.pointer) return;
    if (!drag.hasMoved && !isDragged(drag.from, at)) return;
    if (!drag.hasMoved) picture.setPointerCapture(event.pointerId);
    drag.hasMoved = hasMoved = true;
    if (drag.moves) acts.onMove(at.x - drag.last.x, at.y - drag.last.y);
    else acts.onMark(drag.from, at, false);
    drag.last = at;
  };
  const onUp = (event: PointerEvent) => {
    if (drag?.hasMoved && !drag.moves) acts.onMark(drag.from, pointIn(picture, event), true);
    drag = null;
  };
  const onClick = (event: MouseEvent) => {
    if (!hasMoved && !isOver(event)) acts.onTap(pointIn(picture, event));
  };
  on(picture, "pointerdown", onDown, signal);
  on(picture, "pointermove", onMove, signal);
  on(picture, "pointerup", onUp, signal);
  on(picture, "pointercancel", () => (drag = null), signal);
  on(picture, "pointerleave", () => acts.onPoint(null), signal);
  on(picture, "click", onClick, signal);
}
