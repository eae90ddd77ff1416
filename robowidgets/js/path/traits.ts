import type { SampleTraits } from "../shared/traits.ts";

export interface PathTraits extends SampleTraits {
  /** Of each point, as float64: seconds, x, y in metres, yaw in radians, metres of the way so far. */
  _path: DataView;
}
