/** Start and end in seconds from the start of the recording, and a label. Marks are sorted by start. */
export type Mark = [number, number, string];

/** The start of the next mark, or of the one before; undefined where there is none. */
export function markBeside(marks: Mark[], time: number, direction: -1 | 1): number | undefined {
  const starts = marks.map(([start]) => start);
  return direction > 0 ? starts.find((start) => start > time) : starts.filter((start) => start < time).at(-1);
}
