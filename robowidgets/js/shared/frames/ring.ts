import { Reader } from "../bytes.ts";
import { type Frame, readHead } from "../stream.ts";
import type { About } from "../traits.ts";
import { classify, type Limits, READING, TOO_CLOSE, type Validity } from "./scan.ts";

/** The newest range of one sensor; metres, seconds and radians. */
export interface Sonar extends Limits {
  /** As measured. */
  range: number;
  kind: Validity;
  /** By how much it is older than the newest of all; infinite: none has come yet. */
  behind: number;
  /** How old it may be before the sensor is silent. */
  silentAfter: number;
  /** 0: not known. */
  fieldOfView: number;
  /** On the robot, metres and radians of its frame: x, y, yaw; null: not known. */
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
    // Without a limit, +inf is no reading either.
    const kind = classify(range, minRange, Math.min(maxRange, LARGEST));
    const pose: Sonar["pose"] = Number.isNaN(x) ? null : [x, y, yaw];
    return { range, kind, behind, silentAfter, minRange, maxRange, fieldOfView, pose };
  });
  return { ...head, sonars };
}

/** The metres that a program goes by, as `Range.distance` in Python: 0 too close, infinite nothing in range, NaN unknown. */
export function distanceOf({ range, kind, minRange, maxRange }: Sonar): number {
  if (kind === READING) return range;
  if (kind === TOO_CLOSE) return 0;
  if (range > maxRange || range === Infinity) return Infinity;
  return range < minRange && range >= CODES_END ? 0 : NaN;
}

/** Index of the sensor with the nearest thing; -1 where nothing is in range, or all is unknown. */
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
  /** Whether somebody said so. */
  isKnown: boolean;
}

/** By the name of a sensor, metres and radians of the robot's frame. */
export type Poses = Record<string, [x: number, y: number, yaw: number]>;

/**
 * The places of sensors: those given, else those that their readings tell, and the others evenly by their order,
 * counter-clockwise from forward.
 */
export function toMounts(names: string[], poses: Poses, told: Sonar["pose"][] = []): Mount[] {
  return names.map((name, i) => {
    const pose = Object.hasOwn(poses, name) ? poses[name] : told[i];
    if (pose) return { x: pose[0], y: pose[1], yaw: pose[2], isKnown: true };
    return { x: 0, y: 0, yaw: (2 * Math.PI * i) / names.length, isKnown: false };
  });
}

/** Radians of an infrared beam that does not tell its width: three degrees. */
const THIN = Math.PI / 60;

/** Radians of the opening of a sensor; of one that does not tell it, the usual one. */
function viewOf({ fieldOfView }: Sonar, radiation: string, usual: number): number {
  return fieldOfView || (radiation === "infrared" ? Math.min(THIN, usual) : usual);
}

/** What Python says about the newest ranges. */
export interface SonarAbout extends About {
  /** In the order of the frame. */
  sensors?: [name: string, radiation: string, frameId: string][];
  /** Whether time stands still, as in a recording. */
  still?: boolean;
}

/** A sensor of a ring, where it is, and what it measured. */
export interface Placed {
  name: string;
  radiation: string;
  frameId: string;
  mount: Mount;
  sonar: Sonar;
  /** Radians of its opening. */
  view: number;
}

/** The sensors of a ring in the order of the frame. @param usual radians of the opening of those that do not tell it */
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
