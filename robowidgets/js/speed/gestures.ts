/** What a person can do to the bars. */
export interface Gestures {
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

/** Hovering and clicking name an axis, and so does tapping; arrow keys walk. */
export function watchGestures(element: HTMLElement, gestures: Gestures, signal: AbortSignal): void {
  const toAxis = (event: Event): number | null => {
    const axis = (event.target as Element).closest<HTMLElement>("[data-axis]")?.dataset.axis;
    return axis === undefined ? null : Number(axis);
  };
  element.addEventListener(
    "pointermove",
    (event) => {
      if (event.pointerType !== "touch") gestures.onHover(toAxis(event));
    },
    { signal },
  );
  element.addEventListener("pointerleave", () => gestures.onHover(null), { signal });
  element.addEventListener("click", (event) => gestures.onPick(toAxis(event)), { signal });
  element.addEventListener(
    "keydown",
    (event) => {
      const to = WALK[event.key];
      if (!to || event.ctrlKey || event.altKey || event.metaKey) return;
      gestures.onWalk(to);
      event.preventDefault();
    },
    { signal },
  );
}
