import { type AngleUnit, decimalsFor, sideOf, toAngle, toFixed, toMany, toMetres } from "../shared/format.ts";
import { meaningOf } from "../shared/frames/classes.ts";
import { angleOf, type Scan } from "../shared/frames/scan.ts";
import type { PopupWords } from "../shared/popup.ts";
import type { About } from "../shared/traits.ts";
import type { ToShown } from "./mount.ts";

/**
 * The source of a ray's range in the data that its scan was made of, by Python's template; "" if the scan is the
 * source.
 */
export function sourceOf(scan: Scan, index: number, about: About): string {
  const number = scan.sources[index];
  const [, code = ""] = about.made_of ?? [];
  if (number === undefined || Number.isNaN(number)) return "";
  return code.replace("{ray}", `${index}`).replace("{number}", `${number}`);
}

/**
 * The texts of the pop-up of a ray.
 *
 * @param reach metres of the picture, which set the decimals
 * @param unit in which the angle is shown
 * @param more a text with more about the ray
 * @param toShown converts to the angle on show
 */
export function describeRay(
  scan: Scan,
  index: number,
  reach = 1,
  unit: AngleUnit = "deg",
  more = "",
  toShown: ToShown = (angle) => angle,
): PopupWords {
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
  const shown = toShown(angle);
  const intensity = scan.intensities[index];
  const parts = [meaningOf(scan, index)];
  const isReading = parts[0] === "";
  if (isReading) {
    const metres = (value: number) => (range < 1000 ? toFixed(value, decimalsFor(reach)) : toMetres(value, reach));
    const [x, y] = [Math.cos(shown), Math.sin(shown)].map((part) => metres(range * part));
    // Each number stays with its letter in a narrow pop-up.
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
    angle: toAngle(shown, unit),
    details: [...parts, ...(more ? [more] : [])].join("\n"),
    side: sideOf(angle),
  };
}
