import { toFixed } from "../shared/format.ts";
import { angleOf, type Sweep } from "../shared/frames/scan.ts";

/** The angle of a ray as a student would work it out, line by line: names, numbers, result. */
interface Formula {
  names: string;
  numbers: string;
  radians: string;
  degrees: string;
  /** What a full turn less makes of it, as the label of the ray has it; nothing within half a turn. */
  wrapped: string;
}

const [FEWEST, MOST] = [5, 15];
/** Keeps an operator with the number behind it, so that a line breaks in front of operators. */
const NBSP = "\u00A0";

/**
 * The formula of the angle of a ray, with its numbers: with so many digits, at least five, that who types them into a
 * calculator reads the result that stands below.
 *
 * @param offset radians in the angles of the sweep that the scanner's own do not have
 */
export function angleFormula(sweep: Sweep, index: number, offset = 0): Formula {
  const { angleMin, angleIncrement } = sweep;
  const angle = angleOf(sweep, index);
  const degrees = toDegreesText(angle);
  let shown = FEWEST;
  while (shown < MOST && !same(toDegreesText(Number(angle.toFixed(shown))), degrees)) shown++;
  // Of an increment as many more digits as the index has: they count so many times as much.
  const more = String(index).length;
  for (let digits = shown; ; digits++) {
    const first = short(angleMin - offset, digits);
    const step = short(angleIncrement, digits + more);
    const turn = short(offset, digits);
    const result = Number(first) + index * Number(step) + Number(turn);
    if (digits < MOST && !same(result.toFixed(shown), angle.toFixed(shown))) continue;
    const minus = Number(step) < 0 ? `(${signed(step)})` : step;
    return {
      names: `angle_min +${NBSP}${index} ×${NBSP}increment${offset ? ` +${NBSP}angle_offset` : ""}`,
      numbers: `${signed(first)} +${NBSP}${index} ×${NBSP}${minus}${offset ? ` ${plus(turn)}` : ""}`,
      radians: `${toFixed(angle, shown)}${NBSP}rad`,
      degrees: `${signed(degrees)}°`,
      wrapped: wrap((angle * 180) / Math.PI),
    };
  }
}

/** A decimal without zeros at its end, for `Number`. */
function short(value: number, digits: number): string {
  const text = value.toFixed(Math.min(100, digits));
  return text.includes(".") ? text.replace(/\.?0+$/, "") : text;
}

function toDegreesText(radians: number): string {
  return ((radians * 180) / Math.PI).toFixed(2);
}

/** Whether two decimals are the same number: "-0.00" is "0.00". */
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
