import type { AngleUnit } from "../shared/format.ts";
import type { SampleTraits } from "../shared/traits.ts";
import type { Footprint } from "./footprint.ts";
import type { Sector, Stretch } from "./sector.ts";

/** The picked sector: a kept one by its name, another one with its angles and limits, or none. */
export interface Selection extends Partial<Sector> {
  name?: string;
}

/** Rays that are lit, by stretches of the array or by a sector, and the text on them. */
export interface Highlight {
  text?: string;
  stretches?: Stretch[];
  sector?: Sector;
}

/**
 * How far the picture reaches: "sensor" (range_max, if it sets a limit), "data" (fit to the readings), metres, or "auto":
 * the first scan decides between "sensor" and "data".
 */
export type ViewRange = "sensor" | "data" | "auto" | number;

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
  /** Radians by which the angles are turned. */
  angle_offset: number;
  /** True if the scanner's own angles are shown. */
  own_angles: boolean;
  forward: "up" | "left" | "down" | "right";
  /** Classes whose rays are marked. */
  marks: string[];
  color_by_intensity: boolean;
  /** Of a cloud, the lower and the upper height in metres of the points that are a scan; null: all. */
  band: [low: number, high: number] | null;
  /** Which of several echoes of a ray is its range. */
  echo: "first" | "last" | "strongest";
  index_view: boolean;
  free_space: boolean;
  /** How many scans before the one on show are behind it. */
  trail: number;
  /** Over how many scans the spread of each ray is drawn; 0: it is not. */
  spread: number;
  /** Indices of rays. */
  hovered: number | null;
  pinned: number | null;
  _sectors: Record<string, Sector>;
  _selection: Selection;
  /** Indices of rays by name. */
  _pins: Record<string, number>;
  _highlight: Highlight;
  /** The robot to scale; empty: none. */
  _robot: Partial<Footprint>;
  /** In which angles are shown. */
  angle_unit: AngleUnit;
  /** Whether the pop-up of the pinned ray shows how its angle is worked out. */
  formula: boolean;
  /** The frame of a pinned scan; empty without one. */
  _ghost: DataView;
  /** How many scans before the one on show; 0: none. */
  _ghost_ago: number;
  /** The name of the model of another laser widget; empty: none. */
  _ghost_of: string;
  /** The name of the model of a sonar widget, whose cones are drawn; empty: none. */
  _sonar_of: string;
}
