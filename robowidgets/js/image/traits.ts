import type { About, LargeTraits } from "../shared/traits.ts";
import type { Over } from "./overlay.ts";

export interface ImageTraits extends LargeTraits {
  /** Numbers at the ends of the colors; null: fitted. */
  color_range: [number, number] | null;
  /** First row, row after the last, first column, column after the last; null: nothing is marked. */
  region: [number, number, number, number] | null;
  /** fx, fy, cx, cy in pixels; null: not known. */
  camera: [number, number, number, number] | null;
  /** Whether readings lie over the picture. */
  overlay: boolean;
}

/** What Python says about the newest picture. */
export interface ImageAbout extends About {
  encoding?: string;
  /** A letter for each channel; missing for one channel. */
  channels?: string;
  /** Whether the page has colors made of the channels, not the channels. */
  recolored?: boolean;
  /** Of the data in its message; missing where there is none. */
  row_bytes?: number;
  pixel_bytes?: number;
  /** Whether a recording has no picture up to this time. */
  nothing?: boolean;
  over?: Over;
}
