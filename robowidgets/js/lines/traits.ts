import type { About, SampleTraits } from "../shared/traits.ts";

export interface LinesTraits extends SampleTraits {
  folded: boolean;
  _code: VersionCode;
  _drive: DriveGraphs;
  _chosen: ChosenLine;
  /** The text of the button that runs the code; empty without one. */
  _offer: string;
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
