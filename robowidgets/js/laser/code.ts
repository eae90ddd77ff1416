import type { Sweep } from "../shared/frames/scan.ts";
import type { Mount } from "../shared/traits.ts";
import { DEGREE, inDegrees, type Sector, stretchesOf, sweepOf, toExpression } from "./sector.ts";

export const FORMS = ["scan", "message", "slice"] as const;
export type Form = (typeof FORMS)[number];
export const ABOUT_FORMS = "for a Scan of robowidgets, for a ROS message without it, or the plain slice";

const QUARTERS: Record<string, [number, number]> = {
  front: [-45, 45],
  left: [45, 135],
  back: [135, 225],
  right: [-135, -45],
};

/** Python that computes the distance of a sector, for a reader to paste. `robowidgets/samples/sector_code.py` has the same texts. */
export function toCode(sector: Sector, form: Form, sweep: Sweep, angleOffset = 0, mount?: Mount): string {
  if (form === "slice") return toArrayCode(sector, sweep);
  return form === "scan" ? toScanCode(sector) : toMessageCode(sector, angleOffset, mount);
}

function toScanCode({ start, end }: Sector): string {
  const isQuarter = ([from, to]: [number, number]) => from * DEGREE === start && to * DEGREE === end;
  const name = Object.keys(QUARTERS).find((key) => isQuarter(QUARTERS[key] as [number, number]));
  if (name) return `scan.distance("${name}")`;
  // Python would take a sector that goes far round to a smaller angle for one with swapped angles.
  const turns = start > end && sweepOf({ start, end }) > Math.PI ? (end <= 0 ? [0, 1] : [-1, 0]) : [0, 0];
  return `scan.distance((${toAngleCode(start, turns[0])}, ${toAngleCode(end, turns[1])}))`;
}

/** An angle as a program writes it, after some full turns. */
function toAngleCode(radians: number, turns = 0): string {
  if (toAngleText(radians)) return `"${toDecimals(inDegrees(radians) + 360 * turns, 4)}deg"`;
  return toRadiansText(radians + 2 * Math.PI * turns);
}

function toArrayCode(sector: Sector, sweep: Sweep): string {
  const found = stretchesOf(sweep, sector);
  const expression = toExpression(found, sweep.count) || "ranges[0:0]";
  return found.length < 2 ? expression : `np.concatenate((${expression.replaceAll(" +", ",")}))`;
}

function toMessageCode(sector: Sector, angleOffset: number, mount?: Mount): string {
  const degrees = (radians: number) => `${toDecimals(inDegrees(radians), 1)}°`;
  const turned = angleOffset ? ` of a picture turned by ${degrees(angleOffset)}` : "";
  const stands = mount ? ` of the robot, with the scanner ${mount.words}` : "";
  const words = `from ${degrees(sector.start)} to ${degrees(sector.end)}${stands}${turned}`;
  const yaw = mount?.yaw ?? 0;
  // Upside down, the scanner comes to the end of the sector first.
  const start = mount?.upside_down ? yaw - (sector.end - angleOffset) : sector.start - angleOffset - yaw;
  return `\
import numpy as np


def distance(msg, start=${toRadiansText(start)}, sweep=${toRadiansText(sweepOf(sector))}):
    """Metres to the nearest thing, ${words}: 0 too close, inf nothing met, nan unknown."""
    r = np.array(msg.ranges, np.float32)
    angles = msg.angle_min + np.arange(r.size) * (msg.angle_increment if r.size > 1 else 0)
    r = r[(angles - start + 1e-6) % (2 * np.pi) <= sweep + 2e-6]
    low, high = np.float32(msg.range_min), np.float32(msg.range_max)
    code = (r < low) & (r < 0.0195) & (r > -np.inf)  # 0.0 and the like: nothing was seen
    r[r > high] = np.inf
    r[r < low] = 0
    r[code] = np.nan
    return float(np.fmin.reduce(r, initial=np.nan))


distance(msg)
`;
}

/** An angle in radians as "20deg", if at most four decimals of degrees give exactly that angle; else "". */
function toAngleText(radians: number): string {
  const text = toDecimals(inDegrees(radians), 4);
  return Number(text) * DEGREE === radians ? `${text}deg` : "";
}

function toRadiansText(radians: number): string {
  const text = toDecimals(radians, 7);
  return text.includes(".") ? text : `${text}.0`;
}

/** A finite number with at most so many decimals, without needless zeros. A tie goes away from zero. */
function toDecimals(value: number, most: number): string {
  const text = value.toFixed(most).replace(/\.?0+$/, "");
  return text === "-0" ? "0" : text;
}
