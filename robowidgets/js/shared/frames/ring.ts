import { Reader } from "../bytes.ts";
import { type Frame, readHead } from "../stream.ts";
import type { About } from "../traits.ts";
import { classify, type Limits, READING, TOO_CLOSE, type Validity } from "./scan.ts";

/** The newest range of one sensor; metres, seconds and radians. */
export interface Sonar extends Limits {
  /** The measured range. */
  range: number;
  kind: Validity;
  /** Seconds by which it is older than the newest of all; infinite before the first one. */
  behind: number;
  /** Seconds after which the sensor is silent. */
  silentAfter: number;
  /** 0 if unknown. */
  fieldOfView: number;
  /** On the robot, metres and radians of its frame: x, y, yaw; null if unknown. */
  pose: [x: number, y: number, yaw: number] | null;
}

export interface Ring extends Frame {
  sonars: Sonar[];
}

/** Metres; a smaller range that is also below the least one is a code. Python has the same number. */
const CODES_END = 0.0195;
const LARGEST = 3.4e38;

/** A frame of Python: the head, the number of sensors, then nine columns of float32. */
export function decodeRing(bytes: DataView): Ring {
  const reader = new Reader(bytes);
  const head = readHead(reader);
  const count = reader.float64();
  const columns = Array.from({ length: 9 }, () => reader.float32s(count));
  const sonars = Array.from({ length: count }, (_, i) => {
    const row = columns.map((column) => column[i] as number);
    const [range = NaN, behind = 0, silentAfter = 0, minRange = 0, maxRange = 0, fieldOfView = 0] = row;
    const [x = NaN, y = NaN, yaw = NaN] = row.slice(6);
    // Without a limit, +inf is not a reading.
    const kind = classify(range, minRange, Math.min(maxRange, LARGEST));
    const pose: Sonar["pose"] = Number.isNaN(x) ? null : [x, y, yaw];
    return { range, kind, behind, silentAfter, minRange, maxRange, fieldOfView, pose };
  });
  return { ...head, sonars };
}

/**
 * The distance in metres for a program, the same as `Range.distance` in Python: 0 too close, infinite nothing in range,
 * NaN unknown.
 */
export function distanceOf({ range, kind, minRange, maxRange }: Sonar): number {
  if (kind === READING) return range;
  if (kind === TOO_CLOSE) return 0;
  if (range > maxRange || range === Infinity) return Infinity;
  return range < minRange && range >= CODES_END ? 0 : NaN;
}

/** Index of the sensor with the nearest thing; -1 if nothing is in range, or all is unknown. */
export function nearestOf(sonars: Sonar[]): number {
  let found = -1;
  let least = Infinity;
  for (const [i, sonar] of sonars.entries()) {
    const distance = distanceOf(sonar);
    if (distance < least) {
      least = distance;
      found = i;
    }
  }
  return found;
}

/** A place on the robot: metres and radians of its frame. */
export interface Mount {
  x: number;
  y: number;
  yaw: number;
  /** True if the place is given by the user or by messages. */
  isKnown: boolean;
}

/** By the name of a sensor, metres and radians of the robot's frame. */
export type Poses = Record<string, [x: number, y: number, yaw: number]>;

/**
 * The places of sensors: the given ones, else the ones in their readings, and the others evenly by their order,
 * counter-clockwise from forward.
 */
export function toMounts(names: string[], poses: Poses, told: Sonar["pose"][] = []): Mount[] {
  return names.map((name, i) => {
    const pose = Object.hasOwn(poses, name) ? poses[name] : told[i];
    if (pose) return { x: pose[0], y: pose[1], yaw: pose[2], isKnown: true };
    return { x: 0, y: 0, yaw: (2 * Math.PI * i) / names.length, isKnown: false };
  });
}

/** Radians of an infrared beam of unknown width: three degrees. */
const THIN = Math.PI / 60;

/** Radians of the opening of a sensor, or the usual ones if its messages lack them. */
function viewOf({ fieldOfView }: Sonar, radiation: string, usual: number): number {
  return fieldOfView || (radiation === "infrared" ? Math.min(THIN, usual) : usual);
}

/** Facts about the newest ranges, from Python. */
export interface SonarAbout extends About {
  /** In the order of the frame. */
  sensors?: [name: string, radiation: string, frameId: string][];
  /** True if time stands still, as in a recording. */
  still?: boolean;
}

/** A sensor of a ring, with its place and its measurement. */
export interface Placed {
  name: string;
  radiation: string;
  frameId: string;
  mount: Mount;
  sonar: Sonar;
  /** Radians of its opening. */
  view: number;
}

/**
 * The sensors of a ring in the order of the frame. @param usual radians of the opening of sensors whose messages lack
 * it
 */
export function toPlaced({ sonars }: Ring, about: SonarAbout, poses: Poses, usual: number): Placed[] {
  const sensors = sonars.map((_, i) => about.sensors?.[i] ?? ([`${i}`, "", ""] as const));
  const names = sensors.map(([name]) => name);
  const told = sonars.map(({ pose }) => pose);
  const mounts = toMounts(names, poses, told);
  return sonars.map((sonar, i) => {
    const [name, radiation, frameId] = sensors[i] as [string, string, string];
    return { name, radiation, frameId, mount: mounts[i] as Mount, sonar, view: viewOf(sonar, radiation, usual) };
  });
}
