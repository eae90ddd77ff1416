import type { SampleTraits } from "../shared/traits.ts";

/** How far the picture reaches: "sensor" (range_max, if it sets a limit), "data" (fit to the readings), or metres. */
export type ViewRange = "sensor" | "data" | number;

export interface LaserTraits extends SampleTraits {
  view_range: ViewRange;
  /** Null: at round distances. */
  arc_count: number | null;
  /** Metres. */
  arc_distances: number[];
  /** Null: at round angles. */
  ray_count: number | null;
  /** Radians. */
  ray_angles: number[];
  forward: "up" | "left" | "down" | "right";
  /** Classes whose rays are marked. */
  marks: string[];
  color_by_intensity: boolean;
  index_view: boolean;
  /** Indices of rays. */
  hovered: number | null;
  pinned: number | null;
}
