import type { Mark } from "../shared/marks.ts";
import type { StateSpan } from "../shared/states/states.ts";
import type { Look } from "../shared/traits.ts";

export interface PlayerTraits {
  theme: Look;
  /** Seconds from the start of the recording. */
  time: number;
  duration: number;
  /** Seconds at which it begins: 0, or later if an exported page has a part of the recording. */
  _begin: number;
  playing: boolean;
  speed: number;
  loop: boolean;
  selection: [number, number] | null;
  marks: Mark[];
  /** Spans that the user named. */
  labels: Mark[];
  /** Rows of states below the slider, outer machines first. */
  states: StateSpan[][];
  /** Seconds of a segment. */
  _segment: number;
  /** Names of the models of the widgets that show frames. */
  _targets: string[];
  /** For each target, seconds after which its newest frame is old, or 0 for never. */
  _pauses: number[];
  /** Names of the models of the widgets that show the time itself. */
  _followers: string[];
  /** The segments that a page shows first; a notebook without a kernel holds no others. */
  _first: SegmentMessage[];
  /** Seconds since the epoch. */
  _start: number | null;
  /** Seconds that the widgets show: the time, the moment under the pointer, or the frozen moment. */
  _shown: number | null;
  /** The player that this one follows; empty without one. */
  _leader: Partial<Leader>;
  /** Why the recording can be read no further; else empty. */
  _status: string;
  _note: string;
  /** Bytes of the data that an exported page unpacks, or 0 with a kernel. */
  _unpacking: number;
}

/** Another player, and the times here at which this robot was at the places of the other. */
export interface Leader {
  /** Name of its model. */
  model: string;
  /** Its times in seconds, in order, as float64. */
  times: DataView;
  /** For each of them, the time of the same place here; NaN without one. */
  seconds: DataView;
  /** The text without such a place. */
  lost: string;
}

/** A segment of the recording: the frames of each target, in the buffers of the message. */
export interface SegmentMessage {
  /** Its number. */
  segment: number;
  /** Numbers of segments that the page is to forget. */
  drop: number[];
  /** For each target, the facts about its frames. */
  abouts: Record<string, unknown>[][];
  /** The frames, instead of the buffers, if it is in the state of the model. */
  tracks: DataView[];
}
