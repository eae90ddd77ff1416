import { type Speeds, STEERING } from "../shared/frames/speeds.ts";

/** One axis of a velocity, numbered as in Python's AXES, or the steering angle of a car. */
export interface Axis {
  index: number;
  /** As a program writes it: "angular.z". */
  name: string;
  letter: string;
  /** The name of the rotation; "" for the linear axes. */
  word: string;
  /** The directions of a positive and a negative speed (REP-103). */
  directions: [string, string];
  /** True for an axis along which a robot on the ground moves. */
  planar: boolean;
}

export interface Group {
  name: "linear" | "angular" | "steering";
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

const [GROUND, TURNS] = [toGroup("linear", "m/s", 0, LINEAR), toGroup("angular", "rad/s", 3, ANGULAR)];
const WHEELS: Group = {
  name: "steering",
  unit: "rad",
  axes: [{ index: STEERING, name: "steering", letter: "", word: "angle", directions: ["left", "right"], planar: true }],
};
const AHEAD: Group = { ...GROUND, axes: GROUND.axes.slice(0, 1) };

/** The axes of a widget: velocity; for a car its steering angle, too, or only the angle and the forward speed. */
export type Layout = "velocity" | "both" | "car";

const GROUPS: Record<Layout, Group[]> = {
  velocity: [GROUND, TURNS],
  both: [GROUND, TURNS, WHEELS],
  car: [AHEAD, WHEELS],
};

export function groupsOf(layout: Layout): Group[] {
  return GROUPS[layout];
}

/** The axes for some speeds. A car that turns by its wheels has only a forward speed. */
export function layoutOf(speeds: Pick<Speeds, "measured" | "commanded"> | null): Layout {
  const given = [speeds?.measured, speeds?.commanded].filter((values) => values != null);
  const isSteered = (values: number[]) => !Number.isNaN(values[STEERING] ?? NaN);
  if (!given.some(isSteered)) return "velocity";
  return given.every(isSteered) ? "car" : "both";
}

/** Returns true if an axis is on show. */
export function isShown(axis: Axis, planar: boolean): boolean {
  return axis.planar || !planar;
}

/** The name of an axis on the picture and in sentences: "x", "yaw". */
export function toLabel({ letter, word }: Axis): string {
  return word || letter;
}
