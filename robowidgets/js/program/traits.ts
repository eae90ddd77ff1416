import type { Told } from "../shared/driving/traits.ts";
import type { NamedTraits } from "../shared/traits.ts";

export interface ProgramTraits extends NamedTraits {
  _state: ProgramTold;
}

/** State of the robot's driver and of its program, as Python sends it. */
export interface ProgramTold extends Told {
  program: Program | null;
  variables: Variable[];
  /** Names and texts of the values that the program keeps in its state. */
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
  /** Seconds since the version began to drive. */
  since: number;
  /** The speed that the last step returned: m/s forward, rad/s counter-clockwise, m/s to the left. */
  speed: [number, number, number];
  /** True if it returned None, which keeps the speed. */
  kept: boolean;
  /** Limits of the speeds, each 0 if the robot cannot move in that way. */
  limits: [number, number, number];
  /** The active states of a state machine. */
  active: string;
  /** Seconds and text of the last lines, oldest first. */
  prints: [number, string][];
}

/** A value that the user may set; with ends if it has a slider. */
export interface Variable {
  name: string;
  value: number | boolean | string;
  /** The value of the previous version. */
  before: number | boolean | string;
  low: number | null;
  high: number | null;
  unit: string;
  /** True for integers; a slider of integers has no other numbers. */
  whole: boolean;
}
