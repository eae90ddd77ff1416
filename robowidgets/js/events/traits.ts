import type { About, SampleTraits } from "../shared/traits.ts";

export type LevelName = "DEBUG" | "INFO" | "WARN" | "ERROR" | "FATAL";

export interface EventsTraits extends SampleTraits {
  /** The least level on show. */
  level: LevelName;
  /** Words that rows on show contain, or "" for all rows. */
  words: string;
  /** The time cursor, in seconds; null for the newest row. */
  time: number | null;
  /** Rows as JSON, oldest first: older rows, which are sent seldom, and the rows after them. */
  _old: DataView;
  _new: DataView;
  /** Start and end of the recording in seconds, or empty while live. */
  _span: number[];
  /** Seconds since the epoch at second 0; null if times have no such origin. */
  _start: number | null;
}

/** Facts about the newest events, from Python. */
export interface EventsAbout extends About {
  /** Number of older rows that are left out. */
  older?: number;
}
