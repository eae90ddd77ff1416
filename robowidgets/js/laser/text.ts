import { type AngleUnit, decimalsFor, toAngle, toFixed, toMany, toMetres, toShortMetres } from "../shared/format.ts";
import {
  angleOf,
  type Limits,
  NO_LIMIT,
  NO_MEASUREMENT,
  NOTHING_IN_RANGE,
  OUTSIDE_LIMITS,
  READING,
  type Scan,
  TOO_CLOSE,
  type Validity,
} from "./scan.ts";

/** Names of the classes, in the legend and in the trait `marks`. */
export const CLASSES: { kind: Validity; name: string; symbol: string; word: string; explained: string }[] = [
  { kind: READING, name: "reading", symbol: "\u25A0", word: "readings", explained: "a distance within limits" },
  {
    kind: OUTSIDE_LIMITS,
    name: "outside_limits",
    symbol: "\u25CB",
    word: "outside",
    explained: "a distance outside limits",
  },
  {
    kind: NOTHING_IN_RANGE,
    name: "nothing_in_range",
    symbol: "\u2502",
    word: "nothing",
    explained: "+inf: nothing in range",
  },
  { kind: NO_MEASUREMENT, name: "no_measurement", symbol: "\u00D7", word: "none", explained: "NaN: no measurement" },
  {
    kind: TOO_CLOSE,
    name: "too_close",
    symbol: "\u25BE",
    word: "too close",
    explained: "\u2212inf: too close to measure",
  },
];

interface Classed extends Limits {
  kinds: Validity[];
}

/** What a ray without a reading means; nothing for a reading. */
export function meaningOf({ kinds, minRange, maxRange }: Classed, index: number): string {
  switch (kinds[index]) {
    case READING:
      return "";
    case TOO_CLOSE:
      return `\u2212inf: closer than ${toShortMetres(minRange)}`;
    case NOTHING_IN_RANGE:
      return `+inf: nothing ${maxRange > NO_LIMIT ? "in range" : `within ${toShortMetres(maxRange)}`}`;
    case NO_MEASUREMENT:
      return "NaN: no measurement";
    default:
      return `outside the limits ${toShortMetres(minRange)} to ${maxRange > NO_LIMIT ? "\u221e" : toShortMetres(maxRange)}`;
  }
}

/** What the pop-up says of one ray. */
export interface RayWords extends Partial<Where> {
  expression: string;
  distance: string;
  details: string;
}

interface Where {
  angle: string;
  side: string;
}

/**
 * @param reach metres of the picture, which set the decimals
 * @param unit in which the angle is shown
 */
export function describeRay(scan: Scan, index: number, reach = 1, unit: AngleUnit = "deg"): RayWords {
  const expression = `ranges[${index}]`;
  if (index >= scan.count) {
    return {
      expression,
      distance: "\u2014",
      angle: "",
      details: `this scan has ${toMany(scan.count, "ray")}`,
      side: "",
    };
  }
  const range = scan.ranges[index] as number;
  const angle = angleOf(scan, index);
  const intensity = scan.intensities[index];
  const parts = [meaningOf(scan, index)];
  const isReading = parts[0] === "";
  if (isReading) {
    const [x, y] = [Math.cos(angle), Math.sin(angle)].map((part) => toFixed(range * part, decimalsFor(reach)));
    // Each number stays with its letter where the pop-up is narrow.
    parts[0] = `x\u00A0${x}  y\u00A0${y}`;
  }
  if (intensity !== undefined) parts.push(`intensity ${toFixed(intensity, Number.isInteger(intensity) ? 0 : 2)}`);
  return {
    expression,
    distance: isReading
      ? toMetres(range, reach)
      : Number.isFinite(range)
        ? `${toFixed(range, 3)} m`
        : toFixed(range, 0),
    angle: toAngle(angle, unit),
    details: parts.join("\n"),
    side: sideOf(angle),
  };
}

/** The words of a pop-up in the order in which they are heard. */
export function toSentence({ expression, distance, angle, side, details }: RayWords): string[] {
  return [expression, distance, angle ?? "", side ?? "", details.replaceAll(/\s*\n\s*/g, ", ").replaceAll("  ", ", ")];
}

/** The side of the robot on which an angle lies. */
export function sideOf(angle: number): string {
  const turned = Math.atan2(Math.sin(angle), Math.cos(angle));
  if (Math.abs(turned) < 0.0009) return "ahead";
  if (Math.abs(turned) > Math.PI - 0.0009) return "behind";
  return turned > 0 ? "left" : "right";
}
