import { toFixed } from "../shared/format.ts";
import { toLabels } from "./names.ts";
import type { Measures } from "./rows.ts";

/** The style of a line. */
export interface Pen {
  width: number;
  dash: number[];
}

/** Distinguishable without colour, also if two lie over each other. */
const PENS: Pen[] = [
  { width: 1.75, dash: [] },
  { width: 1.25, dash: [2.5, 2] },
  { width: 1.25, dash: [7, 4] },
  { width: 1.25, dash: [8, 3, 2, 3] },
];

export const MOST_GRAPHS = 3;

/** The digits that a number of 64 bits certainly has. */
const MOST_DIGITS = 15;
/** Characters for which the scale has room. */
const MOST_ON_SCALE = 9;

/** A line: its name and a short one, its place among all, and its pen. */
export interface Entry {
  name: string;
  label: string;
  index: number;
  pen: Pen;
  /** True if it is drawn in gray, for comparison. */
  isGhost: boolean;
  /** True if it holds each value until the next. */
  isStepped: boolean;
  /** The reason why it is not drawn, or "" if it is. */
  left: "" | "off" | "crowded";
}

/** The lines of one unit, which share a graph. */
export interface Group {
  unit: string;
  entries: Entry[];
}

/** Settings of lines. */
export interface Wanted {
  units: Record<string, string>;
  off?: string[];
  ghosts?: string[];
  steps?: string[];
}

/**
 * Groups of lines by unit, in the order in which the lines were added. The first four of a graph are drawn, so that
 * their pens differ, and the first three graphs; the user can switch lines off to make room for others.
 */
export function toGroups(names: string[], { units, off = [], ghosts = [], steps = [] }: Wanted): Group[] {
  const groups = new Map<string, Group>();
  const labels = new Map<string, string>();
  for (const unit of new Set(names.map((name) => unitOf(units, name)))) {
    const own = names.filter((name) => unitOf(units, name) === unit);
    for (const [i, label] of toLabels(own, names).entries()) labels.set(own[i] as string, label);
  }
  for (const [index, name] of names.entries()) {
    const unit = unitOf(units, name);
    const group = groups.get(unit) ?? { unit, entries: [] };
    groups.set(unit, group);
    const isGhost = ghosts.includes(name);
    const before = group.entries.filter((entry) => entry.isGhost === isGhost && !entry.left).length;
    const drawn = [...groups.values()].filter(isDrawn).length;
    const isCrowded = before >= PENS.length || (!isDrawn(group) && drawn >= MOST_GRAPHS);
    const left = off.includes(name) ? "off" : isCrowded ? "crowded" : "";
    const pen = PENS[before % PENS.length] as Pen;
    const label = labels.get(name) ?? name;
    group.entries.push({ name, label, index, pen, isGhost, isStepped: steps.includes(name), left });
  }
  return [...groups.values()];
}

export function isDrawn({ entries }: Group): boolean {
  return entries.some(({ left }) => !left);
}

function unitOf(units: Record<string, string>, name: string): string {
  return Object.hasOwn(units, name) ? (units[name] as string) : "";
}

/** A number of at most so many digits, with a real minus sign: "0.3", "−12.5", "1.2e−9". Whole numbers have all. */
export function toDigits(value: number, digits: number): string {
  if (Number.isNaN(value)) return "NaN";
  const rounded = Number.isSafeInteger(value) ? value : Number(value.toPrecision(digits));
  return String(rounded).replace(/-/g, "\u2212");
}

/** So many digits, and as many more as all numbers from the least to the greatest have in common. */
export function digitsWithin(digits: number, measures: Measures | null): number {
  if (!measures || measures.least === measures.most) return digits;
  const { least, most } = measures;
  const common = Math.floor(Math.log10(Math.max(Math.abs(least), Math.abs(most)) / (most - least)));
  return Math.min(MOST_DIGITS, digits + Math.max(0, common));
}

/** A number of a scale with such a step, with the digits that the step needs; "\u2026" for the first of very many. */
export function toScale(value: number, step: number): string {
  const short = value.toExponential(1);
  const isShort = (Math.abs(value) >= 1e6 || step < 1e-5) && Math.abs(Number(short) - value) < step / 100;
  const text = isShort ? short : toFixed(value, decimalsOf(step));
  const cut = text.length > MOST_ON_SCALE ? `\u2026${text.slice(1 - MOST_ON_SCALE)}` : text;
  return cut.replace(/-/g, "\u2212");
}

function decimalsOf(step: number): number {
  let decimals = 0;
  while (decimals < MOST_DIGITS && !isWhole(step * 10 ** decimals)) decimals++;
  return decimals;
}

function isWhole(value: number): boolean {
  return Math.abs(value - Math.round(value)) <= 1e-4 * Math.abs(value);
}
