import type { About, SampleTraits } from "../shared/traits.ts";

export type LevelName = "DEBUG" | "INFO" | "WARN" | "ERROR" | "FATAL";

export interface EventsTraits extends SampleTraits {
  /** The least level on show. */
  level: LevelName;
  /** Words that rows on show have; empty: all. */
  words: string;
  /** The time cursor, in seconds; null: the newest row. */
  time: number | null;
  /** Rows as JSON, oldest first: those that are sent seldom, and those after them. */
  _old: DataView;
  _new: DataView;
  /** Start and end of the recording in seconds; empty: live. */
  _span: number[];
  /** Seconds since the epoch at second 0; null: times are seconds. */
  _start: number | null;
}

/** What Python says about the newest events. */
export interface EventsAbout extends About {
  /** How many older rows are left out. */
  older?: number;
}
