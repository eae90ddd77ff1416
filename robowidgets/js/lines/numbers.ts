import { tokensOf } from "./python.ts";
import type { NumberCode } from "./traits.ts";

/** The numbers between which a slider goes, and its step, which has so many digits after the point. */
export interface Range {
  low: number;
  high: number;
  step: number;
  digits: number;
}

const MOST_DIGITS = 12;
/** The least number of steps of a slider. */
const STEPS = 40;

/** Returns the value of a number in a source: "- 2" and "1_000", too. */
export const toNumber = (text: string) => Number(text.replace(/[\s_]/g, ""));

/** Returns the range of a slider for a number in a source: from zero to twice the number, in 40 to 400 steps. */
export function rangeOf(text: string): Range {
  const value = toNumber(text);
  const isWhole = !/[.eE]/.test(text);
  const high = isWhole ? Math.max(2 * Math.abs(value), 10) : 2 * (Math.abs(value) || 0.5);
  const power = Math.floor(Math.log10(high / STEPS) + 1e-9);
  const digits = isWhole ? 0 : Math.min(MOST_DIGITS, Math.max(1, -power));
  const step = isWhole ? Math.max(1, 10 ** power) : Math.max(10 ** power, 10 ** -MOST_DIGITS);
  const [low, top] = value < 0 ? [-high, 0] : value > 0 ? [0, high] : [-high, high];
  return { low, high: top, step, digits };
}

/** Returns the source of a number within a range, without needless zeros. */
export function textIn({ low, high, step, digits }: Range, value: number): string {
  const [least, most] = [Math.ceil(low / step - 1e-9), Math.floor(high / step + 1e-9)];
  const steps = Math.min(Math.max(Math.round(value / step), least), most);
  const text = (steps * step).toFixed(digits);
  const short = digits > 1 ? text.replace(/0+$/, "").replace(/\.$/, ".0") : text;
  return Number(short) === 0 ? short.replace("-", "") : short;
}

/** A part of a line: its kind for its colour, its text, and the number that the user can change, if it is one. */
export type Part = [kind: string, text: string, number?: NumberCode];

/** Returns the parts of a line of a source. `numbers` are its numbers, in order. */
export function partsOf(text: string, numbers: NumberCode[]): Part[] {
  const letters = [...text];
  const parts: Part[] = [];
  let at = 0;
  for (const number of numbers) {
    const [, column, written] = number;
    parts.push(...tokensOf(letters.slice(at, column).join("")), ["number", written, number]);
    at = column + [...written].length;
  }
  parts.push(...tokensOf(letters.slice(at).join("")));
  return parts;
}
