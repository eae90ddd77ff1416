import type { DrivingTraits } from "../shared/driving/traits.ts";

export interface StopTraits extends DrivingTraits {
  /** Name of the group that its Freeze freezes; empty: it has none. */
  _together: string;
  /** Name of the robot of that group. */
  _robot: string;
}
