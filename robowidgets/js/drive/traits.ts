import type { StopTraits } from "../shared/driving/traits.ts";

export interface DriveTraits extends StopTraits {
  enabled: boolean;
  /** m/s and rad/s. */
  linear_limit: number;
  angular_limit: number;
}
