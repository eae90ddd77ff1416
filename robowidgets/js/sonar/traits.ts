import type { About, SampleTraits } from "../shared/traits.ts";

export interface SonarTraits extends SampleTraits {
  /** By the name of a sensor, metres and radians of the robot's frame: [x, y, yaw]. */
  poses: Record<string, [x: number, y: number, yaw: number]>;
  /** Metres below which a distance is an alarm. */
  near: number | null;
  /** Radians; of sensors that do not tell theirs. */
  field_of_view: number;
  /** Metres to the edge of the picture; null: as far as the sensors reach. */
  view_range: number | null;
}

/** What Python says about the newest ranges. */
export interface SonarAbout extends About {
  /** In the order of the frame. */
  sensors?: [name: string, radiation: string, frameId: string][];
  /** Whether time stands still, as in a recording. */
  still?: boolean;
}
