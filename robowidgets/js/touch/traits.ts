import type { SampleTraits } from "../shared/traits.ts";

export interface TouchTraits extends SampleTraits {
  /** Names of those on show, in their order; all when empty. */
  sensors: string[];
  labels: Record<string, string>;
  /** Radians counter-clockwise from forward. */
  angles: Record<string, number>;
}
