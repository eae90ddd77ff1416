import { toFixed } from "../shared/format.ts";
import { toLabel } from "./axes.ts";
import type { AxisFacts } from "./facts.ts";
import { judge, type State } from "./limits.ts";
import { isOff } from "./scale.ts";
import type { Limits } from "./traits.ts";

const MINUS = "\u2212";

/** A speed with some decimals, or fewer if it would be wider than a column. The pop-up shows all of them. */
export function toNumber(value: number, decimals: number): string {
  const size = Math.abs(value);
  if (!Number.isFinite(value) || size < 100) return toFixed(value, decimals);
  if (size < 1e5) return toFixed(value, size < 1000 ? 1 : 0);
  return value.toExponential(1).replace("e+", "e").replace("-", MINUS);
}

/** Text instead of the number of an axis: a dash before the first sample, "no value" for NaN. */
export function toValueText(value: number | null, decimals: number): string {
  if (value === null) return "\u2013";
  return Number.isNaN(value) ? "no value" : toNumber(value, decimals);
}

/** A number with as many decimals as it needs: "1", "0.5", "−0.22". */
export function toShort(value: number): string {
  return String(Number(value.toPrecision(6))).replaceAll("-", MINUS);
}

/** The mark and the words of a state; the second word is hidden in a narrow card. */
export function stateWords(state: State, limits: Limits | null = null): [mark: string, word: string, more: string] {
  if (isBackwards(limits, state)) return ["\u25BC", "over", "limit"];
  if (state === "over") return ["\u25B2", "over", "limit"];
  if (state === "under") return ["\u25BC", "under", "limit"];
  return ["", "", ""];
}

/** Returns true if a speed is too large in the direction of the negative sign. */
function isBackwards(limits: Limits | null, state: State): boolean {
  return state === "under" && limits !== null && limits[0] < 0;
}

/** A speed past its limits in words: "over the limit of 1"; "" for one within them. */
function toStateText(value: number, limits: Limits | null): string {
  const state = judge(value, limits);
  if (!limits || (state !== "over" && state !== "under")) return "";
  const limit = limits[state === "over" ? 1 : 0];
  // A speed to the right is over its limit, as one to the left: the direction says which way.
  return isBackwards(limits, state)
    ? `over the limit of ${toShort(-limit)}`
    : `${state} the limit of ${toShort(limit)}`;
}

/** The texts of the pop-up of one axis. */
export interface AxisWords {
  expression: string;
  direction: string;
  value: string;
  /** The problem of the value; "" within its limits. */
  alarm: string;
  /** Name and value, line by line. */
  details: [string, string][];
}

export function describeAxis(facts: AxisFacts): AxisWords {
  const { axis, unit, measured, commanded, peaks, limits, scale } = facts;
  const decimals = facts.decimals + 2;
  const say = (value: number) => {
    const number = Number.isNaN(value) ? "no value" : toFixed(value, decimals);
    return `${number} ${toStateText(value, limits)}`.trim();
  };
  const details: [string, string][] = limits ? [["limits", `${toShort(limits[0])} to ${toShort(limits[1])}`]] : [];
  if (commanded !== null) details.push(["commanded", say(commanded)]);
  if (peaks) details.push(["least", say(peaks[0])], ["greatest", say(peaks[1])]);
  const expression = axis.word ? `${axis.word} (${axis.name})` : axis.name;
  const words = { expression, direction: "", value: "not measured", alarm: "", details };
  if (measured === null) return words;
  const isMoving = Math.abs(measured) >= 0.5 * 10 ** -decimals;
  const alarm = toStateText(measured, limits);
  return {
    ...words,
    direction: isMoving ? axis.directions[measured > 0 ? 0 : 1] : "",
    value: Number.isNaN(measured) ? "no value" : `${toFixed(measured, decimals)} ${unit}`,
    alarm: [alarm, isOff(measured, scale) ? "off the scale" : ""].filter(Boolean).join(", "),
  };
}

/** The words of a pop-up in the order in which a screen reader reads them. */
export function toSentence({ expression, value, direction, alarm, details }: AxisWords): string[] {
  return [expression, value, direction, alarm, ...details.map((pair) => pair.join(" "))];
}

/** One line about all axes for the footer, including hidden ones that move; "" before the first speed. */
export function summarize(shown: AxisFacts[], hidden: AxisFacts[]): string {
  const past = [...shown, ...hidden].flatMap(({ axis, measured, limits }) => {
    const state = measured === null ? "" : toStateText(measured, limits);
    return state ? [`${toLabel(axis)} ${state}`] : [];
  });
  const moving = hidden.flatMap(({ axis, measured, decimals }) => {
    const isSeen = measured !== null && Math.abs(measured) >= 0.5 * 10 ** -decimals;
    return isSeen ? [`${toLabel(axis)} ${toNumber(measured, decimals)}`] : [];
  });
  const hasValue = shown.some(({ measured }) => measured !== null && !Number.isNaN(measured));
  const parts = [past.length > 2 ? `${past.length} past their limits` : past.join(", ")];
  const hasLimits = [...shown, ...hidden].some(({ limits }) => limits);
  if (!past.length && hasValue && hasLimits) parts[0] = "within limits";
  if (moving.length) parts.push(`not shown: ${moving.join(", ")}`);
  return parts.filter(Boolean).join(" · ");
}
