import type { Mark } from "../shared/marks.ts";
import type { FrameTraits } from "../shared/traits.ts";
import type { StateSpan } from "./states.ts";

/** Seconds from the start. */
export type Span = [number, number];

/** Which of the readings that share a pixel is shown. */
export type Pixel = "nearest" | "median";

export interface ScanogramTraits extends FrameTraits {
  time: number;
  /** Start and end; of some rays also the first, and the first that is not among them. */
  selection: number[] | null;
  /** The time on show; null: all of it. */
  view: Span | null;
  /** Metres of the nearest and the farthest colour; null: of the readings on show. */
  color_range: [number, number] | null;
  pixel: Pixel;
  marks: Mark[];
  /** Rows of states below the strips, outer machines first. */
  states: StateSpan[][];
  /** Start and end of the finer detail that the page lacks, and for how many columns. */
  _wanted: number[];
  _detail: DataView;
}

/** Traits for other widgets in the page; Python has none of this name. */
export interface Pointing {
  /** The time at which a person points, and the index of the ray; null below the scans, or where there are none. */
  _pointed: { time: number; ray: number | null } | null;
  /** Index of a ray at which a person points on another widget. */
  _ray: number | null;
}
