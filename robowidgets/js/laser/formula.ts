import { toFixed } from "../shared/format.ts";
import { angleOf, type Sweep } from "../shared/frames/scan.ts";
import type { Mount } from "../shared/traits.ts";
import { turnOf } from "./mount.ts";

/** The angle of a ray as a student would calculate it, line by line: names, numbers, result. */
interface Formula {
  names: string;
  numbers: string;
  radians: string;
  degrees: string;
  /** The angle after a full turn is subtracted or added, as on the label of the ray; "" within half a turn. */
  wrapped: string;
}

const [FEWEST, MOST] = [5, 15];
/** Keeps an operator with the number behind it, so that a line breaks in front of operators. */
const NBSP = "\u00A0";

/**
 * The formula of the angle of a ray, with its numbers: with enough digits, at least five, that a calculator gives the
 * result that stands below.
 *
 * @param offset radians that were added to the angles of the sweep
 * @param mount mount of the scanner on the robot, if the sweep has angles of the robot
 * @param isOwn true for the angle of the scanner, without both
 */
export function angleFormula(sweep: Sweep, index: number, offset = 0, mount?: Mount, isOwn = false): Formula {
  const sign = mount?.upside_down ? -1 : 1;
  const yaw = mount ? turnOf(mount) : 0;
  const angleMin = sign * (sweep.angleMin - offset - yaw);
  const angleIncrement = sign * sweep.angleIncrement;
  const angle = isOwn ? angleMin + index * angleIncrement : angleOf(sweep, index);
  const [added, turned, way] = isOwn ? [0, 0, 1] : [offset, yaw, sign];
  const degrees = toDegreesText(angle);
  let shown = FEWEST;
  while (shown < MOST && !same(toDegreesText(Number(angle.toFixed(shown))), degrees)) shown++;
  // An increment has as many more digits as the index: its error is multiplied by the index.
  const more = String(index).length;
  for (let digits = shown; ; digits++) {
    const first = short(angleMin, digits);
    const step = short(angleIncrement, digits + more);
    const [turn, heading] = [short(added, digits), short(turned, digits)];
    const result = way * (Number(first) + index * Number(step)) + Number(heading) + Number(turn);
    if (digits < MOST && !same(result.toFixed(shown), angle.toFixed(shown))) continue;
    const minus = Number(step) < 0 ? `(${signed(step)})` : step;
    const [ownNames, ownNumbers] = [
      `angle_min +${NBSP}${index} ×${NBSP}increment`,
      `${signed(first)} +${NBSP}${index} ×${NBSP}${minus}`,
    ];
    const [names, numbers] =
      way < 0
        ? [`yaw \u2212${NBSP}(${ownNames})`, `${signed(heading)} \u2212${NBSP}(${ownNumbers})`]
        : [`${ownNames}${turned ? ` +${NBSP}yaw` : ""}`, `${ownNumbers}${turned ? ` ${plus(heading)}` : ""}`];
    return {
      names: `${names}${added ? ` +${NBSP}angle_offset` : ""}`,
      numbers: `${numbers}${added ? ` ${plus(turn)}` : ""}`,
      radians: `${toFixed(angle, shown)}${NBSP}rad`,
      degrees: `${signed(degrees)}°`,
      wrapped: wrap((angle * 180) / Math.PI),
    };
  }
}

/** A decimal without trailing zeros, for `Number`. */
function short(value: number, digits: number): string {
  const text = value.toFixed(Math.min(100, digits));
  return text.includes(".") ? text.replace(/\.?0+$/, "") : text;
}

function toDegreesText(radians: number): string {
  return ((radians * 180) / Math.PI).toFixed(2);
}

/** Returns true if two decimals are the same number: "-0.00" is "0.00". */
function same(a: string, b: string): boolean {
  return Number(a) === Number(b);
}

function signed(text: string): string {
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "\u2212");
}

function plus(text: string): string {
  return text.startsWith("-") ? `\u2212${NBSP}${text.slice(1)}` : `+${NBSP}${text}`;
}

function wrap(degrees: number): string {
  if (Math.abs(degrees) <= 180.005) return "";
  const turns = Math.round(degrees / 360);
  const shown = `${toFixed(degrees, 2)}°`;
  const many = Math.abs(turns) > 1 ? `${Math.abs(turns)}${NBSP}×${NBSP}` : "";
  return `${shown} ${turns > 0 ? "\u2212" : "+"}${NBSP}${many}360° =${NBSP}${toFixed(degrees - 360 * turns, 2)}°`;
}
