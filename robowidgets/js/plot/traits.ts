import type { Mark } from "../shared/marks.ts";
import type { StateSpan } from "../shared/states/states.ts";
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
  /** Names of two lines of which the second is drawn over the first; null: all over time. */
  x_over_y: string[] | null;
  paused: boolean;
  /** The last time on show while frozen. */
  _frozen_at: number | null;
  /** All of the lines. */
  _lines: DataView;
  /** A part of them, with more values; empty where all of the lines show each value. */
  _detail: DataView;
  _facts: PlotFacts;
  /** Names of fields of which lines can be made. */
  _choices: string[];
  /** Name of the group that is frozen together; empty: alone. */
  _together: string;
  /** Start and end of what the page looks at, and for how many columns. */
  _wanted: number[];
}

export interface PlotFacts {
  /** Of the lines, in their order. */
  names?: string[];
  /** Whether values come one by one. */
  live?: boolean;
  error?: string;
  /** How many messages did not come, in words. */
  missed?: string;
}
