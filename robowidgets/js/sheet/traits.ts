import type { CardTraits } from "../shared/traits.ts";

/** The moments by column, each with one value for each; Python's `SheetWidget.show`. */
export interface Columns {
  /** Indices of files and topics. */
  file: number[];
  topic: number[];
  /** Seconds from the start of the recording. */
  start: number[];
  end: number[];
  /** The moment on show. */
  time: number[];
  /** Seconds since the epoch; null if the clock of the recording has no date. */
  date: (number | null)[];
  /** Metres; null without a nearest thing. */
  nearest: (number | null)[];
  index: (number | null)[];
  /** The number that a condition compared, or null. */
  value: (number | null)[];
  silent: string[];
}

/** A file that was not read whole. */
export interface OddFile {
  path: string;
  name: string;
  problem: string;
  is_read: boolean;
}

export interface SheetTraits extends CardTraits {
  sort: string;
  rows: boolean;
  one_per_file: boolean;
  every: boolean;
  filters: Record<string, string>;
  picked: number | null;
  false_finds: number[];
  /** By the number of a moment, the name that the user gave it here. */
  labels: Record<string, string>;
  _columns: Partial<Columns>;
  /** Path and name of each file. */
  _files: string[][];
  _topics: string[];
  _unread: OddFile[];
  condition: string;
  /** Files that were named, and those searched so far; null for all. */
  _total: number;
  _done: number | null;
  _pictures: DataView;
  _opened: number | null;
  /** The reason why a moment could not be opened, or "". */
  _status: string;
}
