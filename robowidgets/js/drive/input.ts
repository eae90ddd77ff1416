import { pointIn } from "../shared/dom.ts";
import { isPlain, on, onAbort } from "../shared/events.ts";
import { CENTER, isDriving, type Knob, ofKeys, toKnob, toSlide } from "./knob.ts";

/** Pixels. */
const KNOB_RADIUS = 19;

/** Actions of the user on a pad. */
interface PadInput {
  /** True if the robot moves sideways. */
  readonly sideways: boolean;
  onHold(knob: Knob): void;
  onRelease(): void;
}

/**
 * Follows pointers and keys on a pad and on the slide for sideways: one pointer on each, or keys. A released knob
 * returns to rest while the other one goes on. Losing a pointer, the focus, the window or the page releases both.
 */
export function watchInput(pad: HTMLElement, slide: HTMLElement, input: PadInput, signal: AbortSignal): void {
  const held = new Set<string>();
  const pointers = new Map<HTMLElement, number>();
  let knob = CENTER;
  const release = () => {
    const before = [...pointers];
    pointers.clear();
    held.clear();
    knob = CENTER;
    for (const [surface, pointer] of before) {
      if (surface.hasPointerCapture(pointer)) surface.releasePointerCapture(pointer);
    }
    input.onRelease();
  };
  const move = (part: Partial<Knob>) => {
    knob = { ...knob, ...part };
    input.onHold(knob);
  };

  const watchPointer = (
    surface: HTMLElement,
    toPart: (right: number, below: number, reach: number) => Partial<Knob>,
    atRest: Partial<Knob>,
  ) => {
    const toPlace = (event: PointerEvent): Partial<Knob> => {
      const { x, y } = pointIn(surface, event);
      const { offsetWidth: width, offsetHeight: height } = surface;
      return toPart(x - width / 2, y - height / 2, width / 2 - KNOB_RADIUS);
    };
    const isOurs = ({ pointerId }: PointerEvent) => pointers.get(surface) === pointerId;
    const onDown = (event: PointerEvent) => {
      if (pointers.has(surface) || event.button !== 0) return;
      event.preventDefault();
      pad.focus({ preventScroll: true });
      pointers.set(surface, event.pointerId);
      surface.setPointerCapture(event.pointerId);
      move(toPlace(event));
    };
    const onUp = (event: PointerEvent) => {
      if (!isOurs(event)) return;
      if (pointers.size === 1) return release();
      pointers.delete(surface);
      move(atRest);
    };
    on(surface, "pointerdown", onDown, signal);
    on(surface, "pointermove", (event) => isOurs(event) && move(toPlace(event)), signal);
    on(surface, "pointerup", onUp, signal);
    for (const end of ["pointercancel", "lostpointercapture"] as const) {
      on(surface, end, (event) => isOurs(event) && release(), signal);
    }
  };
  watchPointer(pad, toKnob, { forward: 0, turn: 0 });
  watchPointer(slide, (right, _below, reach) => toSlide(right, reach), { lateral: 0 });

  const onKey = (event: KeyboardEvent) => {
    if (event.key === " " || event.key === "Escape" || !isPlain(event)) {
      if (event.key === " ") event.preventDefault();
      release();
    } else if (isDriving(event.code, input.sideways)) {
      event.preventDefault();
      if (event.repeat) return;
      held.add(event.code);
      if (!pointers.size) input.onHold(ofKeys(held));
    }
  };
  on(pad, "keydown", onKey, signal);
  const onKeyUp = ({ code }: KeyboardEvent) => {
    if (!held.delete(code) || pointers.size) return;
    if (held.size) input.onHold(ofKeys(held));
    else input.onRelease();
  };
  on(pad, "keyup", onKeyUp, signal);

  on(pad, "blur", release, signal);
  for (const gone of ["blur", "pagehide"] as const) on(window, gone, release, signal);
  on(document, "visibilitychange", () => document.hidden && release(), signal);
  onAbort(signal, release);
}
