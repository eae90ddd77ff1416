import { toShortMetres } from "../format.ts";
import {
  type Limits,
  NO_LIMIT,
  NO_MEASUREMENT,
  NOTHING_IN_RANGE,
  OUTSIDE_LIMITS,
  READING,
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
    word: "outside limits",
    explained: "a distance outside limits",
  },
  {
    kind: NOTHING_IN_RANGE,
    name: "nothing_in_range",
    symbol: "\u2502",
    word: "nothing in range",
    explained: "+inf: nothing in range",
  },
  {
    kind: NO_MEASUREMENT,
    name: "no_measurement",
    symbol: "\u00D7",
    word: "no measurement",
    explained: "NaN: no measurement",
  },
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

/** The meaning of a ray without a reading; "" for a reading. */
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
