import type { Mark } from "../shared/marks.ts";
import type { Span } from "../shared/time_axis.ts";
import type { CardTraits } from "../shared/traits.ts";

export interface PlotTraits extends CardTraits {
  /** Name of a line to its unit. */
  units: Record<string, string>;
  /** Seconds on show; null: all, or live the newest. */
  view: Span | null;
  /** Seconds on show while values come; null: all. */
  window: number | null;
  /** The time cursor in seconds. */
  time: number | null;
  marks: Mark[];
  paused: boolean;
  /** The last time on show while frozen. */
  _frozen_at: number | null;
  /** All of the lines. */
  _frame: DataView;
  /** A part of them, with more values; empty where all of the lines show each value. */
  _detail: DataView;
  _about: PlotAbout;
  /** Start and end of what the page looks at, and for how many columns. */
  _wanted: number[];
}

export interface PlotAbout {
  /** Of the lines, in their order. */
  names?: string[];
  /** Whether values come one by one. */
  live?: boolean;
  error?: string;
}
