import type { About, SampleTraits } from "../shared/traits.ts";

export interface LinesTraits extends SampleTraits {
  folded: boolean;
  _code: VersionCode;
  _drive: DriveGraphs;
  _chosen: ChosenLine;
  /** The text of the button that runs the code; empty without one. */
  _offer: string;
  _number: ChangedNumber;
  _compared: ComparedVersions;
}

/** A number in the source of a function that has a slider, or the reason why it has none. */
export type NumberCode = [line: number, column: number, text: string, why: string];

/** The number that the page changes, as Python knows it; empty before the first press. */
export interface ChangedNumber {
  /** The name that the page gave to the press. */
  press?: string;
  text?: string;
  state?: "trying" | "tried" | "refused" | "driving" | "back";
  why?: string;
  /** Proves that the next message is not old. */
  token?: number;
  /** The number of the new version, and why it does not drive yet. */
  version?: number;
  note?: string;
  /** The number before. */
  back?: string;
  steps?: number;
  seconds?: number;
  /** The number of steps with another speed, and with an error. */
  otherwise?: number;
  failed?: number;
  error?: string;
  axes?: EffectAxis[];
}

/** The speeds of both versions on the last seconds. */
export interface EffectAxis {
  axis: string;
  unit: string;
  /** Seconds before the press. */
  at: number[];
  old: (number | null)[];
  new: (number | null)[];
}

/** The steps in which a version decides otherwise than the one before; empty before a second version. */
export interface ComparedVersions {
  key?: string;
  old?: number;
  new?: number;
  why?: string;
  steps?: number;
  seconds?: number;
  otherwise?: number;
  failed?: number;
  error?: string;
  spans?: number;
  rows?: [
    from: number,
    to: number,
    line: number | null,
    oldValue: string,
    newValue: string,
    old: string,
    new_: string,
  ][];
}

/** The graphs of lines over a recording; empty for a robot that drives now. */
export interface DriveGraphs {
  /** Seconds of the recording. */
  from?: number;
  to?: number;
  /** Seconds, in order. */
  times?: number[];
  /** For each function, its lines from 0 with their kinds, and a level at each time; null if it was not reached. */
  lines?: Record<string, [line: number, kind: string, levels: (number | null)[]][]>;
}

/** The line whose spans are marked in the player; empty without one. */
export interface ChosenLine {
  /** Its number in its file. */
  line?: number;
  /** The number of spans. */
  spans?: number;
  /** "line 5 was true". */
  what?: string;
}

/** The functions of a version of a program; empty before the first step. */
export interface VersionCode {
  key?: string;
  name?: string;
  version?: number;
  /** The called functions, in the order of their lines. */
  functions?: FunctionCode[];
}

export interface FunctionCode {
  key: string;
  name: string;
  /** Number of its first line in its file. */
  first: number;
  texts: string[];
  /** Numbers of the lines that may be reached, from 0. */
  code: number[];
  /** The reason why it has no values, or empty if it has values. */
  why: string;
  /** Its numbers, in order; missing over a recording. */
  numbers?: NumberCode[];
  /** Its lines as they stand in the cell, and as they are now; missing if they are the same. */
  cell?: string[];
  changed?: string[];
}

/** The facts of the newest step that are not in its frame. */
export interface LinesAbout extends About {
  mode?: "running" | "paused" | "failed" | "ended" | "replaced";
  version?: number;
  /** An error that belongs to no line. */
  failure?: string;
  /** The assumptions of values that were computed again, in words. */
  assumes?: string;
}
