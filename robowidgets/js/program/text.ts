import type { Told } from "../shared/driving/traits.ts";
import { toFixed } from "../shared/format.ts";
import type { Program, Variable } from "./traits.ts";

/** The state of a program without an answer from Python. */
export const NOT_KNOWN = "not known";

/** The state of running, as a word. */
export function toMode(told: Told, program: Program, isKnown = true): string {
  if (!isKnown) return NOT_KNOWN;
  if (told.stopped) return "stopped";
  return program.mode === "running" && program.waiting ? "waiting" : program.mode;
}

/** The speed that a step returned, as Python code. */
export function toCode([linear, angular, lateral]: Program["speed"], kept: boolean): string {
  const sideways = lateral ? `, lateral=${toPython(lateral)}` : "";
  const drive = `Drive(${toPython(linear)}, ${toPython(angular)}${sideways})`;
  return kept ? `None, keeps ${drive}` : drive;
}

function toPython(value: number): string {
  const text = String(Math.round(value * 1000) / 1000);
  return Number.isInteger(Number(text)) ? `${text}.0` : text;
}

/** The line under the facts: the error, the reason why the program waits, or an event; and true for an error. */
export function toNotice(told: Told, program: Program): { text: string; isError: boolean } {
  const error = told.error || program.error;
  if (error) return { text: error, isError: true };
  if (told.stopped) {
    const drivesOn = program.mode === "running" ? "Allow driving or Run: then it drives on." : "Run.";
    return { text: `Zero until you press ${drivesOn}`, isError: false };
  }
  const isSilent = program.mode !== "running" || program.prints.length === 0;
  return { text: program.waiting || (isSilent ? program.note : ""), isError: false };
}

/** A variable's value with as many decimals as its slider needs. */
export function toValue({ value, low, high, whole }: Variable): string {
  if (typeof value !== "number") return String(value);
  if (low === null || high === null) return String(Math.round(value * 1e6) / 1e6);
  return toFixed(value, decimalsOf(high - low, whole));
}

/** The step of a slider: about a hundredth of its range, a power of ten; 1 for integers. */
export function toStep(low: number, high: number, whole = false): number {
  return 10 ** -decimalsOf(high - low, whole);
}

function decimalsOf(range: number, whole: boolean): number {
  return whole ? 0 : Math.max(0, Math.round(2 - Math.log10(range)));
}
