import type { SampleTraits } from "../shared/traits.ts";

export interface TouchTraits extends SampleTraits {
  /** Names of the sensors on show, in their order; empty for all. */
  sensors: string[];
  labels: Record<string, string>;
  /** Radians counter-clockwise from forward. */
  angles: Record<string, number>;
}
