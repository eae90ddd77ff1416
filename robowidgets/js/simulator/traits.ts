import type { FrameTraits, Shape } from "../shared/traits.ts";

/** A shape on a scan to whose angles its widget adds some radians. */
export interface RoomShape extends Shape {
  turned: number;
}

export interface SimulatorTraits extends FrameTraits {
  paused: boolean;
  /** Name of the group of widgets that are frozen together, which is the robot for a feed, or "" to freeze alone. */
  _together: string;
  /** The frozen picture, or empty while live. */
  _frozen_frame: DataView;
  /** The robot, its newest scan, its path and the obstacles: see `toScene`. */
  _frame: DataView;
  /** The walls as float32: x1, y1, x2, y2 of each, metres. */
  _walls: DataView;
  /** The rectangles without floor as float32: x1, y1, x2, y2 of each, metres. */
  _drops: DataView;
  /** The shapes that programs drew on the newest scan. */
  _shapes: RoomShape[];
  /** The reason why the robot cannot move, or "" while it can. */
  _status: string;
  /** Number of signs of life from Python, one a second; 0 if this widget gets none. */
  _beat: number;
}
