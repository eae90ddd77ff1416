import type { CardTraits } from "../shared/traits.ts";

/** The moments by column, each with one value for each; Python's `SheetWidget.show`. */
export interface Columns {
  /** Indices of files and topics. */
  file: number[];
  topic: number[];
  /** Seconds from the start of the recording. */
  start: number[];
  end: number[];
  /** The moment that is shown. */
  time: number[];
  /** Seconds since the epoch; null where the clock of the recording has no date. */
  date: (number | null)[];
  /** Metres; null where nothing was met. */
  nearest: (number | null)[];
  index: (number | null)[];
  /** What a condition compared; null where it compared no number. */
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
  /** By the number of a moment, the name that a person gave it here. */
  labels: Record<string, string>;
  _columns: Partial<Columns>;
  /** Path and name of each file. */
  _files: string[][];
  _topics: string[];
  _unread: OddFile[];
  condition: string;
  /** Files that were named, and those searched so far; null: all. */
  _total: number;
  _done: number | null;
  _pictures: DataView;
  _opened: number | null;
  /** Why a moment could not be opened; else empty. */
  _status: string;
}
