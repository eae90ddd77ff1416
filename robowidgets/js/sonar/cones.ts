import { distanceOf, type Placed, type Poses, type Ring, type SonarAbout, toPlaced } from "../shared/frames/ring.ts";
import { NO_LIMIT, READING } from "../shared/frames/scan.ts";
import { roundUp } from "../shared/zoom.ts";

/** Metres shown by a picture without a limit or a reading. */
const EMPTY = 2;
/** Seconds; Python sends it for a sensor whose rate is unknown. */
const NO_RATE = 10;

/** The data on show of one sensor. */
export interface Cone extends Placed {
  index: number;
  isViewKnown: boolean;
  /** The distance for a program. */
  distance: number;
  /** True for an alarm. */
  isNear: boolean;
  /** True if it has measured. */
  hasCome: boolean;
  /** Seconds since it measured. */
  age: number;
  isSilent: boolean;
}

interface Settings {
  poses: Poses;
  near: number | null;
  fieldOfView: number;
  /** Seconds since the newest frame arrived; 0 if time stands still. */
  elapsed: number;
}

/** The cones of all sensors in the picture. */
export function toCones(ring: Ring, about: SonarAbout, { poses, near, fieldOfView, elapsed }: Settings): Cone[] {
  return toPlaced(ring, about, poses, fieldOfView).map((placed, index) => {
    const { sonar } = placed;
    const distance = distanceOf(sonar);
    const age = sonar.behind + elapsed;
    // Without a rate, the next measurement has no due time: compare with other sensors.
    const isSilent = (sonar.silentAfter < NO_RATE ? age : sonar.behind) > sonar.silentAfter;
    return {
      ...placed,
      index,
      isViewKnown: sonar.fieldOfView > 0,
      distance,
      isNear: near !== null && distance < near,
      hasCome: sonar.behind < Infinity,
      age,
      isSilent,
    };
  });
}

/** Seconds until the next sensor becomes silent if no frame arrives; infinite if none will. */
export function nextSilence(cones: Cone[]): number {
  const left = cones.flatMap(({ sonar, age, isSilent, hasCome }) =>
    hasCome && !isSilent && sonar.silentAfter < NO_RATE ? [sonar.silentAfter - age] : [],
  );
  return Math.min(Infinity, ...left);
}

/** Metres from the robot's middle, to the decimetre, that hold the reach of all sensors; 0 if none has a limit. */
export function reachOf(cones: Cone[]): number {
  const reaches = cones.flatMap(({ sonar: { maxRange }, mount: { x, y } }) =>
    maxRange <= NO_LIMIT ? [maxRange + Math.hypot(x, y)] : [],
  );
  return Math.ceil(10 * Math.max(0, ...reaches) - 1e-6) / 10;
}

/** A round number of metres that holds all readings; 0 without any. */
export function fitReadings(cones: Cone[]): number {
  const ends = cones.flatMap(({ sonar: { range, kind }, mount: { x, y } }) =>
    kind === READING ? [range + Math.hypot(x, y)] : [],
  );
  return ends.length ? roundUp(1.05 * Math.max(...ends)) : 0;
}

/** Metres to the edge of the picture. Without a limit it holds all readings so far. */
export function resolveRange(setting: number | null, cones: Cone[], before: number): number {
  return setting ?? (reachOf(cones) || Math.max(before, fitReadings(cones)) || EMPTY);
}
