import type { SampleTraits } from "../shared/traits.ts";

/** How far the picture reaches: "sensor" (range_max, if it sets a limit), "data" (fit to the readings), or metres. */
export type ViewRange = "sensor" | "data" | number;

export interface LaserTraits extends SampleTraits {
  view_range: ViewRange;
  arc_count: number;
  /** Metres. */
  arc_distances: number[];
  ray_count: number;
  forward: "up" | "left" | "down" | "right";
  /** Classes whose rays are marked. */
  marks: string[];
  color_by_intensity: boolean;
  /** Indices of rays. */
  hovered: number | null;
  pinned: number | null;
}
