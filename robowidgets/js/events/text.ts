import { toCount, toMany } from "../shared/format.ts";
import { toMoment } from "../shared/time_span.ts";
import { ERROR, levelOf, type Row, WARN } from "./rows.ts";

const [LONGEST_LINE, LONGEST_SAID] = [400, 120];

/** The form of times: from the start of a recording, or, live, by the clock of the page. */
export interface Times {
  span: number[];
  start: number | null;
}

export function toTimeText(seconds: number, { span, start }: Times, decimals = 2): string {
  if (span.length || start === null) return toMoment(seconds, span[1] ?? seconds, decimals);
  const date = new Date(1000 * (start + seconds));
  const two = (value: number) => String(value).padStart(2, "0");
  const part = decimals ? `.${String(date.getMilliseconds()).padStart(3, "0").slice(0, decimals)}` : "";
  return `${two(date.getHours())}:${two(date.getMinutes())}:${two(date.getSeconds())}${part}`;
}

/** A text in one line. */
export function toLine({ text }: Row): string {
  const line = text.slice(0, LONGEST_LINE).replace(/\s+/g, " ").trim();
  return text.length > LONGEST_LINE ? `${line}\u2026` : line;
}

export function toTimes({ count }: Row): string {
  return count > 1 ? `\u00D7 ${toCount(count)}` : "";
}

/** The details of an unfolded row. */
export function describeRow(row: Row, times: Times): string {
  const { seconds, until, count, text, length, source, topic } = row;
  const first = toTimeText(seconds, times, 3);
  const when = count > 1 ? `${toCount(count)} times from ${first} to ${toTimeText(until, times, 3)}` : first;
  const left = length > text.length ? `the first ${toCount(text.length)} of ${toCount(length)} characters` : "";
  return [when, levelOf(row).word, source, topic, left].filter(Boolean).join(" \u00B7 ");
}

/** A row as texts for a screen reader. */
export function toSpoken(row: Row, times: Times): string[] {
  const line = toLine(row);
  const text = line.length > LONGEST_SAID ? `${line.slice(0, LONGEST_SAID)}\u2026` : line;
  const count = row.count > 1 ? `${row.count} times` : "";
  return [levelOf(row).word, toTimeText(row.seconds, times), row.source, text, count];
}

/** Counts errors and warnings among rows. */
export function countLevels(rows: Row[]): { errors: number; warnings: number; others: number } {
  let [errors, warnings, others] = [0, 0, 0];
  for (const { level, count } of rows) {
    if (level >= ERROR) errors += count;
    else if (level >= WARN) warnings += count;
    else others += count;
  }
  return { errors, warnings, others };
}

/** "12 rows", "3 of 12 rows", "the newest 2 000 rows, 40 older left out". */
export function toExtent(shown: number, all: number, older: number): string {
  const rows = shown === all ? toMany(all, "row") : `${toCount(shown)} of ${toMany(all, "row")}`;
  return older ? `${rows} \u00B7 ${toCount(older)} older left out` : rows;
}
