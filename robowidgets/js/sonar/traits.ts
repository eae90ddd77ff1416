import type { Poses } from "../shared/frames/ring.ts";
import type { SampleTraits } from "../shared/traits.ts";

export interface SonarTraits extends SampleTraits {
  /** By the name of a sensor, metres and radians of the robot's frame: [x, y, yaw]. */
  poses: Poses;
  /** Metres below which a distance is an alarm. */
  near: number | null;
  /** Radians, for sensors whose messages lack it. */
  field_of_view: number;
  /** Metres to the edge of the picture; null for the reach of the sensors. */
  view_range: number | null;
}
