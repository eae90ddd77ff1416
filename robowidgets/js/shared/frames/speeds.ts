import { Reader } from "../bytes.ts";
import { type Frame, readHead } from "../stream.ts";

/** The place of the steering angle of a car among the numbers by axis, after the six axes of a velocity. */
export const STEERING = 6;

/** A frame of Python: numbers by axis, m/s and rad/s, then a steering angle in rad; NaN for a missing value. */
export interface Speeds extends Frame {
  /** Null before the first. */
  measured: number[] | null;
  commanded: number[] | null;
  /** The least and the greatest measured since the last reset, without steering angles. */
  least: number[];
  greatest: number[];
  /** Number of resets of the peaks that Python had counted. */
  resets: number;
}

const MEASURED = 1;
const COMMANDED = 2;

export function decodeSpeeds(bytes: DataView): Speeds {
  const reader = new Reader(bytes);
  const head = readHead(reader);
  // Stamp and time of arrival of the command follow, which the page does not use.
  const [there = 0, resets = 0] = reader.float64s(4);
  const [measured, commanded] = [reader.float64s(6), reader.float64s(6)];
  const [least, greatest] = [reader.float64s(6), reader.float64s(6)];
  const [angle = NaN, commandedAngle = NaN] = reader.float64s(2);
  return {
    ...head,
    measured: there & MEASURED ? [...measured, angle] : null,
    commanded: there & COMMANDED ? [...commanded, commandedAngle] : null,
    least,
    greatest,
    resets,
  };
}
