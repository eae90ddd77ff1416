/** "auto": light or dark as the host. "projector": larger. "paper": black on white. A screen's comes first. */
export type Look = "auto" | "light" | "dark" | "projector" | "paper";

/** Traits of every widget with a header. */
export interface NamedTraits {
  theme: Look;
  title: string;
  header: boolean;
  /** The widget's stylesheet. */
  _style: string;
}

/** Traits of a widget with a card: a picture between header and footer. */
export interface CardTraits extends NamedTraits {
  footer: boolean;
}

/** Traits of a widget whose card shows frames and facts about them. */
export interface FrameTraits extends CardTraits {
  _frame: DataView;
  _about: About;
}

/** Traits of a widget that shows the newest of many samples. */
export interface SampleTraits extends FrameTraits {
  paused: boolean;
  /** Name of the group of widgets that are frozen and stepped together, or "" to freeze alone. */
  _together: string;
  /** Seconds for which samples are kept. */
  history: number;
  /** The frozen frame, or empty while live. */
  _frozen_frame: DataView;
  _source: Source;
  /** Age of the newest sample in seconds when the page asked for the state. */
  _silence: number;
  /** Number of signs of life from Python, one a second; 0 if this widget gets none. */
  _beat: number;
}

/** Traits of a widget whose frames are large. */
export interface LargeTraits extends SampleTraits {
  /** True if Python waits until the page reports its drawings. */
  _answers: boolean;
}

/** A problem in plain words, and its remedy, which may be empty. */
export type Problem = readonly [what: string, remedy: string];

/** A sample: its frame, arrival in milliseconds (NaN: in the state at page load), and facts from Python. */
export interface Moment {
  bytes: DataView;
  at: number;
  about: About;
  /** True if samples right before it were dropped, because the picture was frozen for long. */
  isAfterGap?: boolean;
}

/**
 * The mount of a scanner on its robot. An angle of the scanner is `yaw` plus the angle of the robot; upside down, `yaw`
 * minus that angle.
 */
export interface Mount {
  /** Radians; 0 if missing. */
  yaw?: number;
  upside_down?: boolean;
  /** Full turns that are subtracted from the angles of the scan. */
  turns?: number;
  /** For the user: "turned 90.0° by tf". */
  words: string;
}

/** Facts about the newest sample, from Python. */
export interface About {
  frame_id?: string;
  notes?: string[];
  problems?: Problem[];
  /** Why the picture of the sample is empty. */
  empty?: Problem;
  error?: string;
  /** Radians in the angles of a scan that were added to the scanner's own; missing without an offset. */
  angle_offset?: number;
  /** The mount of the scanner on the robot; missing if its angles are angles of the robot. */
  mount?: Mount;
  /**
   * For a scan that was made of other data, their name, and the code of a part of them:
   * `ranges[{ray}].echoes[{number}]`.
   */
  made_of?: [what: string, code: string];
  /** Milliseconds for which a recording has no newer sample; missing unless that is long. */
  age?: number;
  /** True if it is of another moment than the player's, whose sample is not there yet. */
  waits?: boolean;
  lamps?: Lamp[];
  /** The reason why fewer frames are sent than possible. */
  pace?: string;
  /** The shapes that the program drew on the sample. */
  shapes?: Shape[];
  /** Numbers that the program plots, by name; null if it gave none since the previous sample. */
  numbers?: Record<string, number | null>;
  /** The scanner's pose in the frame of odometry: metres and radians. */
  pose?: [x: number, y: number, yaw: number];
  /** The source of this pose if it is not odometry. */
  placed_by?: string;
  /** By name of a layer of a map, the reason why it is not drawn. */
  missing?: Record<string, string>;
  /** Sequence number of the sample that the lamps belong to. */
  judged?: number;
  /**
   * For a recording, the roles of the samples that are new in the frame; empty if no message arrived, missing for all
   * roles.
   */
  new?: string[];
}

/** A place in metres, x forward and y to the left; or the index of a ray, for its reading. */
export type Spot = [x: number, y: number] | number;

/** A shape that the program drew, in metres and radians of the scanner's frame. */
export interface Shape {
  name: string;
  kind: "line" | "points" | "polygon" | "text" | "arc" | "arrow";
  at: Spot[];
  text?: string;
  /** Of an arc: metres, and the angles between which it runs counter-clockwise. */
  radius?: number;
  start?: number;
  end?: number;
  /** Direction of a pose. */
  yaw?: number;
  /** A colour of CSS; missing for the usual colour of shapes. */
  color?: string;
  /** Seconds that remained when Python sent it; missing for a shape that stays. */
  left?: number;
}

/** A condition that Python judged on a sample. */
export interface Lamp {
  name: string;
  /** "off": it raised, and is judged no more. */
  state: "true" | "false" | "unknown" | "off";
  /** The compared values, or the reason why it is off. Plain text. */
  text: string;
  /**
   * Time of its last change, in seconds of Python's monotonic clock, as `arrived` of a frame, or null if it was never
   * judged.
   */
  since: number | null;
  /** Number of changes. */
  changes: number;
  /** First and stop of each run of rays that made it true, one after the other. */
  rays: number[];
}

/** The facts of a feed about its topic, in plain text. Any field may be missing. */
export interface Source {
  /** Name of the robot, the same for all its widgets. */
  robot?: string;
  topic?: string;
  type?: string;
  status?: string;
  /** Error of a function that the program connected to this topic. */
  error?: string;
  /** True while the connection is lost, so that nothing arrives. */
  lost?: boolean;
}

/** Traits of a widget that shows times of a recording, for picking one or selecting a span. */
export interface TimeTraits {
  /** Seconds from the start. */
  time: number;
  /** Start and end; for a selection of rays also the first one, and the one after the last. */
  selection: number[] | null;
}

/** Traits for other widgets in the page; Python has none of this name. */
export interface Picking {
  /** The time that the user picked on a widget, to which a player then goes; undefined without a player. */
  _picked: number | null | undefined;
}

/** Traits for other widgets in the page; Python has none of this name. */
export interface Recent {
  /** The last samples up to the one on show, oldest first, of a widget that a player moves. */
  _recent?: Moment[];
  /** Number of them that a view needs, in addition to the one on show. */
  _needs?: number;
}

/** Traits for other widgets in the page; Python has none of this name. */
export interface Pointing {
  /** The time under the pointer, and the index of the ray; null below the scans, or without scans. */
  _pointed: { time: number; ray: number | null } | null;
  /** Index of the ray at which the user points on another widget. */
  _ray: number | null;
  /** The time at which the user points on another widget, or null. */
  _moment?: number | null;
}
