import type { Mark } from "../shared/marks.ts";
import type { StateSpan } from "../shared/states/states.ts";
import type { Span } from "../shared/time_axis.ts";
import type { CardTraits } from "../shared/traits.ts";

export interface PlotTraits extends CardTraits {
  /** By name of a line, its unit. */
  units: Record<string, string>;
  /** Seconds on show; null for all, or live the newest. */
  view: Span | null;
  /** Seconds on show while values arrive; null for all. */
  window: number | null;
  /** The time cursor in seconds. */
  time: number | null;
  marks: Mark[];
  /** Rows of states below the lines, outer machines first. */
  states: StateSpan[][];
  /** Names of lines that hold each value until the next. */
  steps: string[];
  /** Names of lines that are not drawn. */
  off: string[];
  /** Names of lines that are drawn in gray. */
  ghosts: string[];
  /** Seconds by which ghosts are moved. */
  shift: number;
  /** Names of two lines, of which the second is drawn over the first; null for all over time. */
  x_over_y: string[] | null;
  paused: boolean;
  /** The last time on show while frozen. */
  _frozen_at: number | null;
  /** All of the lines. */
  _lines: DataView;
  /** A part of them, with more values; empty if all of the lines show each value. */
  _detail: DataView;
  _facts: PlotFacts;
  /** Names of fields that can become lines. */
  _choices: string[];
  /** Name of the group that is frozen together, or "" to freeze alone. */
  _together: string;
  /** Start and end of the span that the page shows, and the number of its columns. */
  _wanted: number[];
}

export interface PlotFacts {
  /** Of the lines, in their order. */
  names?: string[];
  /** True if values arrive one by one. */
  live?: boolean;
  error?: string;
  /** The number of lost messages, in words. */
  missed?: string;
}
