import type { About, LargeTraits } from "../shared/traits.ts";

/** From where the points are seen. */
export type ViewName = "above" | "side" | "behind" | "rows";

/** The bounds of points, by field: both belong to it. */
export type Selection = Record<string, [low: number, high: number]>;

export interface CloudTraits extends LargeTraits {
  view: ViewName;
  /** "z", "distance", the name of a field, or "" for one colour. */
  color_by: string;
  /** Values at the ends of the colour scale; null for those on show. */
  color_range: [low: number, high: number] | null;
  selection: Selection;
  /** Null for as many as the page can draw in time. */
  most_points: number | null;
  /** Metres to the edge of the picture; null to fit all points. */
  view_range: number | null;
}

/** Facts about the newest cloud, from Python. */
export interface CloudAbout extends About {
  /** A selection, and the number of points of the whole cloud in it. */
  selected?: [selection: Selection, count: number];
}
