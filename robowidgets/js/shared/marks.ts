import { firstWhere } from "./search.ts";

/** Start and end in seconds from the start of the recording, and a label. Marks are sorted by start. */
export type Mark = [number, number, string];

/** The start of the next or the previous mark; undefined without one. */
export function markBeside(marks: Mark[], time: number, direction: -1 | 1): number | undefined {
  const starts = marks.map(([start]) => start);
  return direction > 0 ? starts.find((start) => start > time) : starts.filter((start) => start < time).at(-1);
}

/** The mark at or before a time: "mark 3 of 6", and its label. Half a hundredth early, as times are shown. */
export function describeMark(marks: Mark[], time: number): { number: string; label: string } {
  const number = firstWhere(marks, ([start]) => start > time + 0.005);
  if (!number) return { number: `${marks.length} mark${marks.length === 1 ? "" : "s"}`, label: "" };
  return { number: `mark ${number} of ${marks.length}`, label: marks[number - 1]?.[2] ?? "" };
}
