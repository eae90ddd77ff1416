import type { About, LargeTraits } from "../shared/traits.ts";

/** From where the points are seen. */
export type ViewName = "above" | "side" | "behind" | "rows";

/** The bounds of points, by field: both belong to it. */
export type Selection = Record<string, [low: number, high: number]>;

export interface CloudTraits extends LargeTraits {
  view: ViewName;
  /** "z", "distance", the name of a field, or "" for one colour. */
  color_by: string;
  /** Values between which the colours lie; null: those on show. */
  color_range: [low: number, high: number] | null;
  selection: Selection;
  /** Null: as many as the page can draw in time. */
  most_points: number | null;
  /** Metres to the edge of the picture; null: as far as the points reach. */
  view_range: number | null;
}

/** What Python says about the newest cloud. */
export interface CloudAbout extends About {
  /** How many points of the whole cloud are within a selection. */
  selected?: [selection: Selection, count: number];
}
