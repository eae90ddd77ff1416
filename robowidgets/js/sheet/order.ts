import { quoted } from "../shared/python.ts";
import type { Columns } from "./traits.ts";

/** A moment of a sheet, in words and numbers. */
export interface Moment {
  number: number;
  path: string;
  /** Name of its file, without the part that all names have. */
  file: string;
  topic: string;
  start: number;
  /** The moment on show. */
  time: number;
  held: number;
  date: number | null;
  nearest: number | null;
  index: number | null;
  value: number | null;
  silent: string;
}

export type Column = "nearest" | "time" | "file" | "topic" | "date" | "held" | "index" | "value";

/** The columns of the table, with their heads. */
export const COLUMNS: readonly { name: Column; head: string; isNumber: boolean }[] = [
  { name: "file", head: "file", isNumber: false },
  { name: "topic", head: "topic", isNumber: false },
  { name: "time", head: "time, s", isNumber: true },
  { name: "held", head: "held, s", isNumber: true },
  { name: "date", head: "date, UTC", isNumber: false },
  { name: "nearest", head: "nearest, m", isNumber: true },
  { name: "index", head: "index", isNumber: true },
  { name: "value", head: "value", isNumber: true },
];

/** All moments of a sheet. */
export function toMoments(columns: Partial<Columns>, files: string[][], topics: string[]): Moment[] {
  const { file = [], topic = [], start = [], end = [], time = [], date = [], nearest = [], index = [] } = columns;
  return file.map((of, number) => ({
    number,
    path: files[of]?.[0] ?? "",
    file: files[of]?.[1] ?? "",
    topic: topics[topic[number] ?? 0] ?? "",
    start: start[number] ?? 0,
    time: time[number] ?? 0,
    held: (end[number] ?? 0) - (start[number] ?? 0),
    date: date[number] ?? null,
    nearest: nearest[number] ?? null,
    index: index[number] ?? null,
    value: columns.value?.[number] ?? null,
    silent: columns.silent?.[number] ?? "",
  }));
}

/** The text of a moment in a column. */
export function cellOf(moment: Moment, column: Column): string {
  const value = moment[column];
  if (value === null) return "";
  if (typeof value === "string") return value;
  if (column === "date") return toDate(value);
  if (column === "value") return String(Number(value.toPrecision(4)));
  if (column === "index") return `[${value}]`;
  return value.toFixed(column === "nearest" || column === "held" ? 2 : 1);
}

/** "2025-06-15 15:06:40". */
export function toDate(seconds: number): string {
  return new Date(seconds * 1000).toISOString().slice(0, 19).replace("T", " ");
}

const SIGNS: Record<string, (value: number, limit: number) => boolean> = {
  "<": (value, limit) => value < limit,
  "<=": (value, limit) => value <= limit,
  "≤": (value, limit) => value <= limit,
  ">": (value, limit) => value > limit,
  ">=": (value, limit) => value >= limit,
  "≥": (value, limit) => value >= limit,
  "=": (value, limit) => value === limit,
};

type Test = (moment: Moment) => boolean;

/** The test of the filter of a column; null for an empty or incomplete filter. */
export function toTest(column: Column, text: string): Test | null {
  const words = text.trim().toLowerCase();
  if (!words) return null;
  const isNumber = COLUMNS.find(({ name }) => name === column)?.isNumber;
  const compared = isNumber && words.match(/^(<=|>=|[<>=≤≥])\s*(-?[\d.]*)$/);
  if (compared) {
    const [, sign = "", limit = ""] = compared;
    const than = Number(limit);
    const holds = SIGNS[sign];
    if (!limit || Number.isNaN(than) || !holds) return null;
    return (moment) => moment[column] !== null && holds(Number(moment[column]), than);
  }
  const between = isNumber && words.match(/^(-?[\d.]+)\s*(?:to|\.\.|–)\s*(-?[\d.]+)$/);
  if (between) {
    const [least, most] = [Number(between[1]), Number(between[2])];
    return (moment) => {
      const value = moment[column];
      return value !== null && Number(value) >= least && Number(value) <= most;
    };
  }
  return (moment) => cellOf(moment, column).toLowerCase().includes(words);
}

/** The moments that pass the filters of all columns. */
export function filtered(moments: Moment[], filters: Record<string, string>): Moment[] {
  const tests = COLUMNS.flatMap(({ name }) => toTest(name, filters[name] ?? "") ?? []);
  return tests.length ? moments.filter((moment) => tests.every((test) => test(moment))) : moments;
}

/** Sorted by a column, in reverse order after a minus; moments without a value are last. */
export function sorted(moments: Moment[], sort: string): Moment[] {
  const isDown = sort.startsWith("-");
  const name = (isDown ? sort.slice(1) : sort) as Column;
  const column = COLUMNS.some((one) => one.name === name) ? name : "nearest";
  const collator = new Intl.Collator("en", { numeric: true });
  const sign = isDown ? -1 : 1;
  const isText = column === "file" || column === "topic";
  // A rank for each text: comparing a text thousands of times takes long.
  const ranks = new Map<string, number>();
  if (isText) {
    const texts = [...new Set(moments.map((moment) => moment[column]))].sort(collator.compare);
    for (const [rank, text] of texts.entries()) ranks.set(text, rank);
  }
  const toValue = (moment: Moment): number | null => {
    if (isText) return ranks.get(moment[column] as string) ?? 0;
    return moment[column] as number | null;
  };
  return [...moments].sort((a, b) => {
    const [x, y] = [toValue(a), toValue(b)];
    if (x === null || y === null) return x === y ? a.number - b.number : x === null ? 1 : -1;
    return sign * (x - y) || a.number - b.number;
  });
}

/** The first of each file. */
export function firstOfEach(moments: Moment[]): Moment[] {
  const seen = new Set<string>();
  return moments.filter(({ path }) => !seen.has(path) && seen.add(path));
}

/** At most so many moments, evenly chosen, and the step between them: every 97th. */
export function evenly(moments: Moment[], most: number): { step: number; chosen: Moment[] } {
  const step = Math.max(1, Math.ceil(moments.length / Math.max(1, most)));
  return { step, chosen: step === 1 ? moments : moments.filter((_, i) => i % step === 0) };
}

/** Metres at which all pictures are cut: about five times the farthest thing; null without one. */
export function cutOf(moments: Moment[]): number | null {
  let most = 0;
  for (const { nearest } of moments) if (nearest !== null && nearest > most) most = nearest;
  if (!most) return null;
  const wanted = 5 * most;
  const power = 10 ** Math.floor(Math.log10(wanted));
  // The farthest thing within a limit lies a little below it.
  const factor = [1, 1.5, 2, 2.5, 3, 4, 5, 7.5, 10].find((one) => one * power >= wanted * 0.98) ?? 10;
  return Number((factor * power).toPrecision(3));
}

/** The code that opens a moment: its sample if it has a nearest thing, else its span. */
export function toCode({ path, topic, nearest, time, start, held }: Moment): string {
  // Rounded up: a time before its sample would find the previous one.
  const up = (seconds: number) => String(Math.ceil(seconds * 1000 - 1e-6) / 1000);
  const opened = `robowidgets.open(${quoted(path)})`;
  if (nearest === null) return `${opened}[${up(start)}:${up(start + Math.max(held, 0.001))}]`;
  return `${opened}.at(${quoted(topic.split(", ")[0] as string)}, ${up(time)})`;
}
