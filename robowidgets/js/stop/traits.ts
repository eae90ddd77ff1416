import type { DrivingTraits } from "../shared/driving/traits.ts";

export interface StopTraits extends DrivingTraits {
  /** Name of the group that its Freeze freezes, or "" without a Freeze. */
  _together: string;
  /** Name of the robot of that group. */
  _robot: string;
  /** Id of the model that its button puts next to the notebook, or "" without a button. */
  _view: string;
  /** The state of the black box of the robot, or "" without one. */
  _black_box: string;
  /** True if that happens as soon as the bar is on the page. */
  _opens: boolean;
}
