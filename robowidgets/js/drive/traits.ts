import type { DrivingTraits, Told } from "../shared/driving/traits.ts";

export interface DriveTraits extends DrivingTraits {
  _state: DriveTold;
  enabled: boolean;
  /** m/s and rad/s. */
  linear_limit: number;
  angular_limit: number;
}

/**
 * State of the robot's driver, and m/s at the ends of the slide for sideways, or 0 if the robot does not move sideways.
 */
export interface DriveTold extends Told {
  lateral_limit: number;
}
