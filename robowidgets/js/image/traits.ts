import type { About, LargeTraits } from "../shared/traits.ts";
import type { Over } from "./overlay.ts";

export interface ImageTraits extends LargeTraits {
  /** Numbers at the ends of the color scale; null to fit it. */
  color_range: [number, number] | null;
  /** First row, row after the last, first column, column after the last; null without a region. */
  region: [number, number, number, number] | null;
  /** fx, fy, cx, cy in pixels; null if unknown. */
  camera: [number, number, number, number] | null;
  /** True if readings lie over the picture. */
  overlay: boolean;
}

/** Facts about the newest picture, from Python. */
export interface ImageAbout extends About {
  encoding?: string;
  /** A letter for each channel; missing for one channel. */
  channels?: string;
  /** True if the page has colors made of the channels instead of the channels. */
  recolored?: boolean;
  /** Bytes of a row in the data of the message; missing without such data, such as for a compressed picture. */
  row_bytes?: number;
  pixel_bytes?: number;
  /** True if a recording has no picture up to this time. */
  nothing?: boolean;
  over?: Over;
}
