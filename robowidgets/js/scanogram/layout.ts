import type { Size } from "../shared/box.ts";
import { ROW, ROW_STEP } from "../shared/states/states.ts";
import type { Whole } from "./data.ts";

/** A horizontal band of the picture. */
export interface Band {
  top: number;
  height: number;
}

/** The layout of the picture, in pixels. */
export interface Layout {
  left: number;
  width: number;
  /** Right end of the room for words. */
  right: number;
  /** Above the scans. */
  marks: Band;
  scans: Band;
  /** True if the angles have their indices below them. */
  indices: boolean;
  /** One for each axis of the speeds that has room. */
  speeds: Band[];
  touch: Band | null;
  /** One for each row of states. */
  states: Band[];
  /** Top of the numbers of the time axis. */
  bottom: number;
  height: number;
}

const TOP = 16;
const MARKS = 7;
const AXIS = 24;
const GAP = 7;
const SPEED = 24;
const TOUCH = 11;
/** Least height of the scans: the speeds give way, the last first. */
const LEAST = 110;
/** Height of the scans from which the angles have their indices below them. */
const ROOMY = 200;

export function layOut({ width, height }: Size, whole: Whole | null, notice: number, rows = 0): Layout {
  const [left, margin] = width < 400 ? [58, 8] : [64, 16];
  const bottom = height - AXIS;
  let top = bottom;
  const take = (size: number): Band => {
    top -= size + GAP;
    return { top: top + GAP, height: size };
  };
  const all = rows ? take(rows * ROW_STEP - (ROW_STEP - ROW)) : null;
  const states = Array.from({ length: rows }, (_, i) => ({ top: (all?.top ?? 0) + i * ROW_STEP, height: ROW }));
  const touch = whole?.touch ? take(TOUCH) : null;
  const room = Math.floor((top - TOP - notice - LEAST) / (SPEED + GAP));
  const count = Math.min(whole?.speed?.axes.length ?? 0, Math.max(0, room));
  const speeds = Array.from({ length: count }, () => take(SPEED)).reverse();
  const scans = { top: TOP + notice, height: Math.max(20, top - TOP - notice) };
  const marks = { top: scans.top - MARKS - 2, height: MARKS };
  const indices = scans.height >= ROOMY;
  const across = { left, width: Math.max(20, width - left - margin), right: width - 2 };
  return { ...across, marks, scans, indices, speeds, touch, states, bottom, height };
}
