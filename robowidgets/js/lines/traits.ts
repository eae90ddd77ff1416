import type { About, SampleTraits } from "../shared/traits.ts";

export interface LinesTraits extends SampleTraits {
  folded: boolean;
  _code: VersionCode;
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
}
