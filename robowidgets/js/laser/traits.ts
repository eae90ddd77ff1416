import type { AngleUnit } from "../shared/format.ts";
import type { SampleTraits } from "../shared/traits.ts";
import type { Footprint } from "./footprint.ts";
import type { Sector, Stretch } from "./sector.ts";

/** The picked sector: the name of a kept one, angles and limits of another one, or nothing. */
export interface Selection extends Partial<Sector> {
  name?: string;
}

/** Highlighted rays, by stretches of the array or by a sector, and the text on them. */
export interface Highlight {
  text?: string;
  stretches?: Stretch[];
  sector?: Sector;
}

/**
 * The range of the picture: "sensor" (range_max, if it sets a limit), "data" (fit to the readings), metres, or "auto":
 * the first scan decides between "sensor" and "data".
 */
export type ViewRange = "sensor" | "data" | "auto" | number;

export interface LaserTraits extends SampleTraits {
  view_range: ViewRange;
  /** Null for arcs at round distances. */
  arc_count: number | null;
  /** Metres. */
  arc_distances: number[];
  /** Null for lines at round angles. */
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
  /** For a cloud, the lower and the upper height in metres of the points that make the scan; null for all points. */
  band: [low: number, high: number] | null;
  /** The echo that is the range of a ray with several. */
  echo: "first" | "last" | "strongest";
  index_view: boolean;
  free_space: boolean;
  /** Number of earlier scans behind the one on show. */
  trail: number;
  /** Number of scans whose spread is drawn for each ray, or 0 for no spread. */
  spread: number;
  /** Indices of rays. */
  hovered: number | null;
  pinned: number | null;
  _sectors: Record<string, Sector>;
  _selection: Selection;
  /** Indices of rays by name. */
  _pins: Record<string, number>;
  _highlight: Highlight;
  /** The robot to scale, or empty to draw none. */
  _robot: Partial<Footprint>;
  /** The unit in which angles are shown. */
  angle_unit: AngleUnit;
  /** True if the pop-up of the pinned ray shows the calculation of its angle. */
  formula: boolean;
  /** The frame of a pinned scan; empty without one. */
  _ghost: DataView;
  /** Compares with the scan so many scans earlier, or 0 not to compare. */
  _ghost_ago: number;
  /** The name of the model of another laser widget, or "". */
  _ghost_of: string;
  /** The name of the model of a sonar widget whose cones are drawn, or "". */
  _sonar_of: string;
}
