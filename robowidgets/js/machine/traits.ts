import type { About, SampleTraits } from "../shared/traits.ts";
import type { Rows } from "./band.ts";

export interface MachineTraits extends SampleTraits {
  _outline: VersionOutline;
}

/** A version of a machine; empty before the first. */
export interface VersionOutline {
  key?: string;
  name?: string;
  /** Several run side by side. */
  machines?: MachineOutline[];
}

/** The states of a machine, the first of which is the initial one, and the moves between them. */
export interface MachineOutline {
  path: string;
  states: StateOutline[];
  moves: MoveOutline[];
}

export interface StateOutline {
  name: string;
  path: string;
  machines: MachineOutline[];
}

/** A move on an event, after some seconds (a number, or the name of one), or, with neither, at once. */
export interface MoveOutline {
  /** "*" for any state of the machine. */
  source: string;
  target: string;
  event: string | null;
  after: string | null;
  /** "on near", "after 0.5" or "at once". */
  why: string;
  /** True if its event may provide the numbers that it compares. */
  compares: boolean;
}

/** Facts about a machine in addition to its frame, from Python. */
export interface MachineAbout extends About {
  mode?: "running" | "paused" | "failed" | "ended";
  version?: number;
  /** The last moves that were made, oldest first. */
  fired?: Fired[];
  states?: Rows;
  /** Path of the state in which a step failed, or "". */
  failed?: string;
}

/** A move that was made. */
export interface Fired {
  /** Seconds of Python's monotonic clock, the same as `arrived` of a frame. */
  at: number;
  /** Seconds since the first step of the program. */
  time: number;
  /** Path of the machine. */
  machine: string;
  source: string;
  target: string;
  why: string;
  /** The numbers that were compared, or "". */
  reading: string;
  /** Index of the nearest ray that the event looked at. */
  index: number | null;
}
