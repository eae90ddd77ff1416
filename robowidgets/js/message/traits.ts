import type { About, SampleTraits } from "../shared/traits.ts";

export interface MessageTraits extends SampleTraits {
  /** Paths of the fields that are shown alone, or empty for all. */
  fields: string[];
  /** Paths of numbers that are drawn over the last seconds. */
  over_time: string[];
  /** True if joints, cells and diagnostics are rows instead of a tree. */
  rows: boolean;
  /** Type of messages that do not contain theirs. */
  type: string;
  /** By path of a part, true if the user or the program unfolded it. */
  folds: Record<string, boolean>;
  /** True if changes are marked. */
  changes: boolean;
  /** True while a view can show a plot of a field. */
  _plots: boolean;
  /** Paths of large parts that are requested from Python. */
  _wanted: string[];
}

/** A field, or a message or an array in the message. Python describes it. */
export interface Node {
  name: string;
  kind: "number" | "flag" | "text" | "time" | "message" | "messages" | "numbers" | "texts";
  /** Type of its numbers, such as `float32`; or the type of a message. */
  type: string;
  unit?: string;
  /** Names of numbers, by the number. */
  names?: Record<string, string>;
  /** Messages in an array. */
  count?: number;
  /** The parts of it that were sent. */
  children?: Node[];
  /** Number of its fields, if they were not sent. */
  folded?: number;
  /** Number of parts in addition to its children. */
  more?: number;
}

/** Facts about the newest message, from Python. */
export interface MessageAbout extends About {
  tree?: Node[];
  type?: string;
  /** True if fields are keys of a dictionary, not attributes. */
  keyed?: boolean;
  /** Topic of a message of a recording. Its frame then has its seconds from the start as its arrival. */
  recorded?: string;
}
