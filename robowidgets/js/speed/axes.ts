/** One axis of a velocity, numbered as in Python's AXES. */
export interface Axis {
  index: number;
  /** As a program writes it: "angular.z". */
  name: string;
  letter: string;
  /** What the rotation is called; nothing for the linear axes. */
  word: string;
  /** Where a positive and a negative speed take the robot (REP-103). */
  directions: [string, string];
  /** Whether a robot on the ground moves so. */
  planar: boolean;
}

export interface Group {
  name: "linear" | "angular";
  unit: string;
  axes: Axis[];
}

type Row = [letter: string, word: string, positive: string, negative: string, planar: boolean];
const LINEAR: Row[] = [
  ["x", "", "forward", "backward", true],
  ["y", "", "left", "right", true],
  ["z", "", "up", "down", false],
];
const ANGULAR: Row[] = [
  ["x", "roll", "rolls right", "rolls left", false],
  ["y", "pitch", "nose down", "nose up", false],
  ["z", "yaw", "left", "right", true],
];

function toGroup(name: Group["name"], unit: string, first: number, rows: Row[]): Group {
  const axes = rows.map(([letter, word, positive, negative, planar], i): Axis => {
    return { index: first + i, name: `${name}.${letter}`, letter, word, directions: [positive, negative], planar };
  });
  return { name, unit, axes };
}

export const GROUPS: Group[] = [toGroup("linear", "m/s", 0, LINEAR), toGroup("angular", "rad/s", 3, ANGULAR)];

/** Whether an axis is on show. */
export function isShown(axis: Axis, planar: boolean): boolean {
  return axis.planar || !planar;
}

/** What an axis is called in a sentence: "linear.x", "yaw". */
export function toLabel({ name, word }: Axis): string {
  return word || name;
}
