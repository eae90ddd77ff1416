/** Of every widget with a header. */
export interface NamedTraits {
  title: string;
  header: boolean;
  /** The widget's stylesheet. */
  _style: string;
}

/** Of a widget with a card: a picture between header and footer. */
export interface CardTraits extends NamedTraits {
  footer: boolean;
}

/** Of a widget whose card shows frames and what is said about them. */
export interface FrameTraits extends CardTraits {
  _frame: DataView;
  _about: About;
}

/** Of a widget that shows the newest of many samples. */
export interface SampleTraits extends FrameTraits {
  paused: boolean;
  /** Name of the group of widgets that are frozen and stepped together; empty: alone. */
  _together: string;
  /** Seconds for which samples are kept. */
  history: number;
  /** The frozen frame; empty when none is. */
  _frozen_frame: DataView;
  _source: Source;
  /** Seconds; how old the newest sample was when the page asked for the state. */
  _silence: number;
  /** Number of signs of life from Python, one a second; 0: this widget gets none. */
  _beat: number;
}

/** Of a widget whose frames are large. */
export interface LargeTraits extends SampleTraits {
  /** Whether Python waits for the page to say what it has drawn. */
  _answers: boolean;
}

/** Something odd, in plain words, and what to do about it, which may be empty. */
export type Problem = readonly [what: string, remedy: string];

/** A sample: its frame, arrival in milliseconds (NaN: in the state at page load), and Python's words about it. */
export interface Moment {
  bytes: DataView;
  at: number;
  about: About;
  /** Whether samples right before it were dropped, because the picture was frozen for long. */
  isAfterGap?: boolean;
}

/** How a scanner stands on its robot: an angle of the scanner is `yaw` plus it of the robot; upside down, `yaw` less it. */
export interface Mount {
  /** Radians; 0 without. */
  yaw?: number;
  upside_down?: boolean;
  /** Full turns by which the angles of the scan are less. */
  turns?: number;
  /** For a person: "turned 90.0° by tf". */
  words: string;
}

/** What Python says about the newest sample. */
export interface About {
  frame_id?: string;
  notes?: string[];
  problems?: Problem[];
  /** Why the picture of the sample is empty. */
  empty?: Problem;
  error?: string;
  /** Radians in the angles of a scan that were added to the scanner's own; missing where none were. */
  angle_offset?: number;
  /** How the scanner stands on the robot, where its angles are not the robot's. */
  mount?: Mount;
  /** Of a scan that was made of other data, what that is, and the code of a part of it: `ranges[{ray}].echoes[{number}]`. */
  made_of?: [what: string, code: string];
  /** Milliseconds for which a recording has nothing newer; missing unless that is long. */
  age?: number;
  /** Whether it is of another moment than the one that a player is asked for, which it does not have yet. */
  waits?: boolean;
  lamps?: Lamp[];
  /** Why fewer frames come than could. */
  pace?: string;
  /** What the program drew on the sample. */
  shapes?: Shape[];
  /** Numbers that the program plots, by name; null where it gave none since the sample before. */
  numbers?: Record<string, number | null>;
  /** Where the scanner was in the frame of odometry: metres and radians. */
  pose?: [x: number, y: number, yaw: number];
  /** Why layers of a map, by their names, are not drawn. */
  missing?: Record<string, string>;
  /** Sequence number of the sample that the lamps tell of. */
  judged?: number;
  /** Of a recording, the roles whose samples came with the frame: none, where no message did. Missing: all of them. */
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
  /** A colour of CSS; none: the one of all that programs draw. */
  color?: string;
  /** Seconds for which it was still there when Python sent it; none: it stays. */
  left?: number;
}

/** A condition that Python judged on a sample. */
export interface Lamp {
  name: string;
  /** "off": it raised, and is judged no more. */
  state: "true" | "false" | "unknown" | "off";
  /** What was compared, or why it is off. Plain text. */
  text: string;
  /** Time of its last change, in seconds of Python's monotonic clock, as `arrived` of a frame; null: never judged. */
  since: number | null;
  /** How often it changed. */
  changes: number;
  /** First and stop of each run of rays that made it true, one after the other. */
  rays: number[];
}

/** What a feed says about its topic, in plain text. Any field may be missing. */
export interface Source {
  /** Name of the robot, the same for all its widgets. */
  robot?: string;
  topic?: string;
  type?: string;
  status?: string;
  /** Error of a function that the program connected to this topic. */
  error?: string;
  /** Whether the connection is lost, so that nothing comes. */
  lost?: boolean;
}

/** Of a widget that shows times of a recording, among which a person picks one or selects a span. */
export interface TimeTraits {
  /** Seconds from the start. */
  time: number;
  /** Start and end; of some rays also the first, and the first that is not among them. */
  selection: number[] | null;
}

/** Traits for other widgets in the page; Python has none of this name. */
export interface Picking {
  /** The time that a person picked on a widget, to which a player then goes; undefined: no player is there. */
  _picked: number | null | undefined;
}

/** Traits for other widgets in the page; Python has none of this name. */
export interface Recent {
  /** The last samples up to the one on show, oldest first, of a widget that a player moves. */
  _recent?: Moment[];
  /** How many of them a view needs, besides the one on show. */
  _needs?: number;
}

/** Traits for other widgets in the page; Python has none of this name. */
export interface Pointing {
  /** The time at which a person points, and the index of the ray; null below the scans, or where there are none. */
  _pointed: { time: number; ray: number | null } | null;
  /** Index of a ray at which a person points on another widget. */
  _ray: number | null;
  /** The time at which a person points on another widget; null: at none. */
  _moment?: number | null;
}
