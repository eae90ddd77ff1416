import type { About, SampleTraits } from "../shared/traits.ts";

export interface MessageTraits extends SampleTraits {
  /** Paths of the fields that are shown alone; empty: all. */
  fields: string[];
  /** Paths of numbers that are drawn over the last seconds. */
  over_time: string[];
  /** Whether joints, cells and diagnostics are rows, not a tree. */
  rows: boolean;
  /** Type of messages that do not tell theirs. */
  type: string;
  /** Path of a part to whether a person, or the program, unfolded it. */
  folds: Record<string, boolean>;
  /** Whether what changed is marked. */
  changes: boolean;
  /** Whether there is a view that can show a plot of a field. */
  _plots: boolean;
  /** Paths of large parts that Python is asked for. */
  _wanted: string[];
}

/** A field, or a message or an array in the message. Python describes it. */
export interface Node {
  name: string;
  kind: "number" | "flag" | "text" | "time" | "message" | "messages" | "numbers" | "texts";
  /** Of its numbers, as `float32`; or the type of a message. */
  type: string;
  unit?: string;
  /** What numbers are called, by the number. */
  names?: Record<string, string>;
  /** Messages in an array. */
  count?: number;
  /** What is in it, as far as it was sent. */
  children?: Node[];
  /** Number of fields in it, none of which was sent. */
  folded?: number;
  /** How many more than its children there are. */
  more?: number;
}

/** What Python says about the newest message. */
export interface MessageAbout extends About {
  tree?: Node[];
  type?: string;
  /** Whether fields are keys of a dictionary, not attributes. */
  keyed?: boolean;
  /** Of a message of a recording: its topic. Its frame then has its seconds from the start as its arrival. */
  recorded?: string;
}
