import { isPlain, on, onAbort } from "../shared/events.ts";
import { isDriving, type Knob, ofKeys, toKnob } from "./knob.ts";

/** Pixels. */
const KNOB_RADIUS = 19;

/** What a person does to a pad. */
interface PadInput {
  onHold(knob: Knob): void;
  onRelease(): void;
}

/** Follows pointer and keys on a pad. Losing the focus, the window or the page releases it. */
export function watchInput(pad: HTMLElement, input: PadInput, signal: AbortSignal): void {
  const held = new Set<string>();
  let pointer: number | null = null;
  const release = () => {
    const was = pointer;
    pointer = null;
    held.clear();
    if (was !== null && pad.hasPointerCapture(was)) pad.releasePointerCapture(was);
    input.onRelease();
  };
  const toPlace = ({ clientX, clientY }: PointerEvent): Knob => {
    const { left, top, width, height } = pad.getBoundingClientRect();
    return toKnob(clientX - left - width / 2, clientY - top - height / 2, Math.min(width, height) / 2 - KNOB_RADIUS);
  };

  const onDown = (event: PointerEvent) => {
    if (pointer !== null || event.button !== 0) return;
    event.preventDefault();
    pad.focus({ preventScroll: true });
    pointer = event.pointerId;
    pad.setPointerCapture(pointer);
    input.onHold(toPlace(event));
  };
  on(pad, "pointerdown", onDown, signal);
  on(pad, "pointermove", (event) => event.pointerId === pointer && input.onHold(toPlace(event)), signal);
  for (const end of ["pointerup", "pointercancel", "lostpointercapture"] as const) {
    on(pad, end, (event) => event.pointerId === pointer && release(), signal);
  }

  const onKey = (event: KeyboardEvent) => {
    if (event.key === " " || event.key === "Escape" || !isPlain(event)) {
      if (event.key === " ") event.preventDefault();
      release();
    } else if (isDriving(event.code)) {
      event.preventDefault();
      if (event.repeat) return;
      held.add(event.code);
      if (pointer === null) input.onHold(ofKeys(held));
    }
  };
  on(pad, "keydown", onKey, signal);
  const onKeyUp = ({ code }: KeyboardEvent) => {
    if (!held.delete(code) || pointer !== null) return;
    if (held.size) input.onHold(ofKeys(held));
    else input.onRelease();
  };
  on(pad, "keyup", onKeyUp, signal);

  on(pad, "blur", release, signal);
  for (const gone of ["blur", "pagehide"] as const) on(window, gone, release, signal);
  on(document, "visibilitychange", () => document.hidden && release(), signal);
  onAbort(signal, release);
}
