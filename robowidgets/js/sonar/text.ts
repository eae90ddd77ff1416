import { sideOf, toAge, toDegrees, toFixed, toMetres, toShortMetres } from "../shared/format.ts";
import { meaningOf } from "../shared/frames/classes.ts";
import { NO_LIMIT, NO_MEASUREMENT, NOTHING_IN_RANGE, READING, TOO_CLOSE } from "../shared/frames/scan.ts";
import type { PopupWords } from "../shared/popup.ts";
import { quoted } from "../shared/python.ts";
import type { Cone } from "./cones.ts";

const LONGEST_NAME = 14;

/** Code for the distance of a sensor in a program. */
export function toCode(name: string): string {
  return `sonars[${quoted(name)}].distance`;
}

/** A name that fits a label: a long one loses its middle. */
export function shorten(name: string): string {
  if (name.length <= LONGEST_NAME) return name;
  return `${name.slice(0, 6)}\u2026${name.slice(-(LONGEST_NAME - 7))}`;
}

/** The distance at the end of a cone: metres or a word, and if room is short the value for a program. */
export function toDistance({ sonar, hasCome, isSilent, isNear, age }: Cone, reach: number, isShort: boolean): string {
  if (!hasCome) return isShort ? "\u2013" : "no data yet";
  if (isSilent) return isShort ? "\u2013" : `silent ${toAge(1000 * age, 0)}`;
  const { range, kind } = sonar;
  const metres = toMetres(range, reach);
  const short = metres.replace(/ m$/, "");
  switch (kind) {
    case READING:
      return isShort ? `${short}${isNear ? "!" : ""}` : `${isNear ? "\u25B2 " : ""}${metres}`;
    case TOO_CLOSE:
      return isShort ? toFixed(range, 0) : `${isNear ? "\u25B2 " : ""}too close`;
    case NOTHING_IN_RANGE:
      return isShort ? toFixed(range, 0) : "nothing";
    case NO_MEASUREMENT:
      return isShort ? "NaN" : "unknown";
    default:
      return isShort ? `${short}?` : "outside";
  }
}

/** An unusual state of a sensor or of its range; "" for a reading. */
function stateOf({ sonar, hasCome, isSilent, age }: Cone): string {
  if (!hasCome) return "no data yet";
  if (isSilent) return `silent for ${toAge(1000 * age)}`;
  const { kind, minRange, maxRange } = sonar;
  return meaningOf({ kinds: [kind], minRange, maxRange }, 0);
}

/** The texts of the pop-up of one sensor. */
export function describeCone(cone: Cone, near: number | null, reach: number): PopupWords {
  const { index, name, radiation, frameId, mount, sonar, view, isViewKnown, isNear, hasCome, age } = cone;
  const { range, kind, minRange, maxRange } = sonar;
  const state = stateOf(cone);
  const measured =
    kind === READING ? toMetres(range, reach) : Number.isFinite(range) ? `${toFixed(range, 3)} m` : toFixed(range, 0);
  const most = maxRange > NO_LIMIT ? "" : ` to ${toShortMetres(maxRange)}`;
  const limits = most || minRange ? `${toShortMetres(minRange)}${most || " or more"}` : "no limits given";
  const place = mount.isKnown ? `x\u00A0${toFixed(mount.x, 2)}  y\u00A0${toFixed(mount.y, 2)}` : "place not known";
  const details = [
    isNear ? `\u25B2 nearer than ${toShortMetres(near ?? 0)}` : "",
    state,
    `beam ${toDegrees(view)}${isViewKnown ? "" : " (not given)"}, ${limits}`,
    [radiation, place].filter(Boolean).join(", "),
    hasCome && !cone.isSilent ? `${toAge(1000 * age, 2)} old` : "",
    frameId && frameId !== name ? frameId : "",
  ];
  return {
    expression: `[${index}] ${name}`,
    distance: hasCome ? measured : "\u2014",
    angle: toDegrees(mount.yaw),
    details: details.filter(Boolean).join("\n"),
    side: sideOf(mount.yaw),
  };
}
