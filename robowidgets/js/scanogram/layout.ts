import type { Size } from "../shared/canvas.ts";
import type { Whole } from "./data.ts";

/** A horizontal band of the picture. */
export interface Band {
  top: number;
  height: number;
}

/** Where everything stands in the picture, in pixels. */
export interface Layout {
  left: number;
  width: number;
  /** Above the scans. */
  marks: Band;
  scans: Band;
  /** One for each axis of the speeds. */
  speeds: Band[];
  touch: Band | null;
  /** Where the numbers of the time axis begin. */
  bottom: number;
  height: number;
}

const TOP = 14;
const MARKS = 7;
const AXIS = 24;
const GAP = 8;
const SPEED = 30;
const TOUCH = 12;

export function layOut({ width, height }: Size, whole: Whole | null, notice: number): Layout {
  const [left, right] = width < 400 ? [58, 8] : [64, 16];
  const bottom = height - AXIS;
  let top = bottom;
  const take = (size: number): Band => {
    top -= size + GAP;
    return { top: top + GAP, height: size };
  };
  const touch = whole?.touch ? take(TOUCH) : null;
  const speeds = (whole?.speed?.axes ?? []).map(() => take(SPEED)).reverse();
  const scans = { top: TOP + notice, height: Math.max(20, top - TOP - notice) };
  const marks = { top: scans.top - MARKS - 2, height: MARKS };
  return { left, width: Math.max(20, width - left - right), marks, scans, speeds, touch, bottom, height };
}
