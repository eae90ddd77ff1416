import type { Span } from "../shared/time_axis.ts";

/** The inputs of the time on show. */
export interface Looking {
  /** The first and the last time of all lines. */
  whole: Span;
  view: Span | null;
  live: boolean;
  /** Seconds that are on show while values arrive; null for all. */
  window: number | null;
  /** The last time on show while frozen; null while it is not. */
  frozenAt: number | null;
}

/** All the time that may be looked at; never of no length. */
export function wholeOf({ whole: [first, last], frozenAt }: Looking): Span {
  const end = Math.min(last, frozenAt ?? last);
  return [first, end > first ? end : first + 1];
}

/** Returns true if the newest values stay on show as they arrive. */
export function follows({ view, live, frozenAt }: Looking): boolean {
  return live && view === null && frozenAt === null;
}

/** The time on show. */
export function seen(looking: Looking): Span {
  const [first, end] = wholeOf(looking);
  const { view, live, window } = looking;
  if (view) return view;
  return [live && window !== null ? Math.max(first, end - window) : first, end];
}
