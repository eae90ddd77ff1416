import type { StopTraits } from "../stop/traits.ts";

export interface DriveTraits extends StopTraits {
  enabled: boolean;
  /** m/s and rad/s. */
  linear_limit: number;
  angular_limit: number;
}
