import { Reader, toBytes } from "../shared/bytes.ts";
import { firstWhere } from "../shared/search.ts";
import { type Frame, readHead } from "../shared/stream.ts";
import type { LevelName } from "./traits.ts";

/** Levels with a number, a sign and a word for each, so that colour is not needed to distinguish them. */
export const LEVELS: readonly { name: LevelName; least: number; sign: string; word: string }[] = [
  { name: "DEBUG", least: 10, sign: "\u00B7", word: "debug" },
  { name: "INFO", least: 20, sign: "\u25E6", word: "info" },
  { name: "WARN", least: 30, sign: "\u25B2", word: "warn" },
  { name: "ERROR", least: 40, sign: "\u2715", word: "error" },
  { name: "FATAL", least: 50, sign: "\u2716", word: "fatal" },
];
export const [WARN, ERROR] = [30, 40];

/** A row of the list: equal events that follow each other. */
export interface Row {
  /** Number among all rows, from 0. */
  number: number;
  /** Seconds of the first and of the last of its events. */
  seconds: number;
  until: number;
  level: number;
  source: string;
  text: string;
  topic: string;
  count: number;
  /** Length of the whole text; `text` may be only its beginning. */
  length: number;
}

/** The moment on show: its seconds, and the number of the first row after it; infinite if the time alone decides. */
export interface EventsFrame extends Frame {
  seconds: number;
  stop: number;
}

export function decodeMoment(bytes: DataView): EventsFrame {
  const reader = new Reader(bytes);
  const head = readHead(reader);
  return { ...head, seconds: reader.float64(), stop: reader.float64() };
}

export function levelOf({ level }: Row): (typeof LEVELS)[number] {
  return (LEVELS.filter(({ least }) => level >= least).at(-1) ?? LEVELS[0]) as (typeof LEVELS)[number];
}

type Listed = [number, number, number, number, string, string, string, number, number];

function decodeRows(value: unknown): Row[] {
  const bytes = toBytes(value);
  if (!bytes) return [];
  return (JSON.parse(new TextDecoder().decode(bytes)) as Listed[]).map(
    ([number, seconds, until, level, source, text, topic, count, length]) => {
      return { number, seconds, until, level, source, text, topic, count, length };
    },
  );
}

/** The filter of the user: a level, and words that a row must all contain. */
export interface Filter {
  level: LevelName;
  words: string;
}

/** All rows of a widget, from its traits, and the rows that pass the filter. */
export class Rows {
  #parts: [unknown, Row[]][] = [
    [undefined, []],
    [undefined, []],
  ];
  #all: Row[] = [];
  #older = 0;
  #key = "";
  #from: Row[] = [];
  #shown: Row[] = [];

  /**
   * All rows, oldest first; the same array as before if nothing changed.
   * @param older the number of forgotten rows
   */
  all(old: unknown, fresh: unknown, older = 0): Row[] {
    const given = [old, fresh];
    if (older === this.#older && given.every((value, i) => value === this.#parts[i]?.[0])) return this.#all;
    this.#older = older;
    this.#parts = given.map((value, i) => {
      const before = this.#parts[i];
      return before && before[0] === value ? before : [value, decodeRows(value)];
    });
    const [before, after] = this.#parts.map(([, rows]) => rows) as [Row[], Row[]];
    const next = after[0]?.number ?? Infinity;
    this.#all = [...before.filter(({ number }) => number < next && number >= older), ...after];
    return this.#all;
  }

  /** The rows that pass a filter; equal neighbours among them are joined into one row. */
  shown(rows: Row[], filter: Filter): Row[] {
    const key = JSON.stringify(filter);
    if (rows === this.#from && key === this.#key) return this.#shown;
    this.#key = key;
    this.#from = rows;
    this.#shown = fold(rows.filter(tester(filter)));
    return this.#shown;
  }
}

function tester({ level, words }: Filter): (row: Row) => boolean {
  const least = LEVELS.find(({ name }) => name === level)?.least ?? 0;
  const wanted = words.toLowerCase().split(/\s+/).filter(Boolean);
  return (row) => {
    if (row.level < least) return false;
    if (!wanted.length) return true;
    const text = `${row.text}\n${row.source}\n${row.topic}`.toLowerCase();
    return wanted.every((word) => text.includes(word));
  };
}

export function fold(rows: Row[]): Row[] {
  const folded: Row[] = [];
  for (const row of rows) {
    const last = folded.at(-1);
    const isAlike =
      last && (["text", "level", "source", "topic", "length"] as const).every((of) => last[of] === row[of]);
    if (isAlike) folded[folded.length - 1] = { ...last, until: row.until, count: last.count + row.count };
    else folded.push(row);
  }
  return folded;
}

/** The index of the last row that began at a time or before it; -1 before the first. */
export function rowAt(rows: Row[], time: number): number {
  return firstWhere(rows, ({ seconds }) => seconds > time) - 1;
}
