import type { DrivingTraits } from "../shared/driving/traits.ts";

export interface StopTraits extends DrivingTraits {
  /** Name of the group that its Freeze freezes; empty: it has none. */
  _together: string;
  /** Name of the robot of that group. */
  _robot: string;
  /** Id of the model that its button puts beside the notebook; empty: it has none. */
  _view: string;
  /** Whether that happens as soon as the bar is on the page. */
  _opens: boolean;
}
