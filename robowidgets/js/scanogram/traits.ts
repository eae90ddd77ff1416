import type { Mark } from "../shared/marks.ts";
import type { StateSpan } from "../shared/states/states.ts";
import type { FrameTraits, TimeTraits } from "../shared/traits.ts";

/** The reading that a pixel shows if several share it. */
export type Pixel = "nearest" | "median";

import type { Span } from "../shared/time_axis.ts";

export interface ScanogramTraits extends FrameTraits, TimeTraits {
  /** The time on show; null for all of it. */
  view: Span | null;
  /** Metres of the nearest and the farthest colour; null to fit the readings on show. */
  color_range: [number, number] | null;
  pixel: Pixel;
  marks: Mark[];
  /** Rows of states below the strips, outer machines first. */
  states: StateSpan[][];
  /** Start and end of the finer detail that the page lacks, and the number of columns. */
  _wanted: number[];
  _detail: DataView;
}
