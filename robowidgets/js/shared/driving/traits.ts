import type { NamedTraits } from "../traits.ts";

export interface DrivingTraits extends NamedTraits {
  _state: Told;
}

/** State of the robot's driver, as Python sends it. */
export interface Told {
  ready: boolean;
  /** "program", "assistant", the name of a press, or "". */
  driver: string;
  /** Seconds until an assistant that drives has to ask again; 0 if it does not drive. */
  left?: number;
  /** The speed that was sent last: m/s forward, rad/s counter-clockwise, m/s to the left. */
  speed: [number, number, number];
  stopped: boolean;
  error: string;
  cause: string;
  status: string;
  /** The cause that moves the robot while no speeds are sent, or "" if it stands still then. */
  idle?: string;
  topic: string;
  /** The sender of the speeds in words, a guard or the kernel, or "" if unknown. */
  sender?: string;
  /** Counts the messages, so that an unchanged state is sent as well. */
  number: number;
}
