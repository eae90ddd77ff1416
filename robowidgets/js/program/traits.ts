import type { Told } from "../shared/driving/traits.ts";
import type { NamedTraits } from "../shared/traits.ts";

export interface ProgramTraits extends NamedTraits {
  _state: ProgramTold;
}

/** State of the robot's driver and of its program, as Python sends it. */
export interface ProgramTold extends Told {
  program: Program | null;
  variables: Variable[];
  /** Names and texts of what the program keeps in its state. */
  kept: [name: string, value: string][];
}

/** State of a program. */
export interface Program {
  name: string;
  version: number;
  mode: "running" | "paused" | "failed" | "ended";
  /** Why it does not step or drive, though it runs; empty if it does. */
  waiting: string;
  error: string;
  note: string;
  /** Steps a second. */
  rate: number;
  step_ms: number;
  /** Seconds since the version is in force. */
  since: number;
  /** What the last step returned: m/s forward, rad/s counter-clockwise, m/s to the left. */
  speed: [number, number, number];
  /** Whether it returned None, which keeps the speed. */
  kept: boolean;
  /** Of each of them; 0: the robot does not move so. */
  limits: [number, number, number];
  /** The active states of a state machine. */
  active: string;
  /** Seconds and text of the last lines, oldest first. */
  prints: [number, string][];
}

/** A value that a person may set; with ends where it has a slider. */
export interface Variable {
  name: string;
  value: number | boolean | string;
  /** The value of the version before. */
  before: number | boolean | string;
  low: number | null;
  high: number | null;
  unit: string;
  /** Whether a number is an integer; a slider of integers has no others. */
  whole: boolean;
}
