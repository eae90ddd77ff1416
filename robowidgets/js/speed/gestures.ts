import { isPlain, on } from "../shared/events.ts";

/** Actions of the user on the bars. */
interface Gestures {
  onHover(axis: number | null): void;
  onPick(axis: number | null): void;
  /** Walks to another axis: "next", "previous", "first", "last" or "none". */
  onWalk(to: string): void;
}

const WALK: Record<string, string> = {
  ArrowRight: "next",
  ArrowLeft: "previous",
  Home: "first",
  End: "last",
  Escape: "none",
};

/** Hovering, clicking and tapping name an axis; arrow keys walk. */
export function watchGestures(element: HTMLElement, gestures: Gestures, signal: AbortSignal): void {
  const toAxis = (event: Event): number | null => {
    const axis = (event.target as Element).closest<HTMLElement>("[data-axis]")?.dataset.axis;
    return axis === undefined ? null : Number(axis);
  };
  const onMove = (event: PointerEvent) => {
    if (event.pointerType !== "touch") gestures.onHover(toAxis(event));
  };
  on(element, "pointermove", onMove, signal);
  on(element, "pointerleave", () => gestures.onHover(null), signal);
  on(element, "click", (event) => gestures.onPick(toAxis(event)), signal);
  const onKey = (event: KeyboardEvent) => {
    const to = WALK[event.key];
    if (!to || !isPlain(event)) return;
    gestures.onWalk(to);
    event.preventDefault();
  };
  on(element, "keydown", onKey, signal);
}
