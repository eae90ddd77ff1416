import type { Mark } from "../shared/marks.ts";

/** Pixels that a mark takes at least, and so the width of a bin. */
const BIN = 3;
/** Opacity of a bin with one mark, and of a bin with the most marks. */
const [LIGHTEST, DARKEST] = [0.4, 1];

/** Marks at a place of the slider, in pixels from its left: a single one, or some that would touch. */
export interface Dense {
  left: number;
  width: number;
  /** Number of marks. */
  count: number;
  /** Opacity, from 0 to 1. */
  share: number;
  label: string;
}

/**
 * Join marks that would touch on a slider to a density: the more marks a bin has, the darker it is.
 *
 * @param marks sorted by start
 * @param width of the slider, in pixels
 */
export function toDensity(marks: Mark[], begin: number, end: number, width: number): Dense[] {
  const toX = (time: number) => ((time - begin) / (end - begin)) * width;
  const groups: { marks: Mark[]; right: number }[] = [];
  for (const mark of marks) {
    const [left, right] = [toX(mark[0]), Math.max(toX(mark[0]) + BIN, toX(mark[1]))];
    const last = groups.at(-1);
    // A pixel between two separates them.
    if (last && left < last.right + 1) {
      last.marks.push(mark);
      last.right = Math.max(last.right, right);
    } else groups.push({ marks: [mark], right });
  }
  const most = Math.max(1, ...groups.flatMap((group) => toCounts(group, toX)));
  return groups.flatMap((group) => toBins(group, toX, most));
}

/** The number of marks of a group in each of its bins. */
function toCounts({ marks, right }: { marks: Mark[]; right: number }, toX: (time: number) => number): number[] {
  const left = toX(marks[0]?.[0] ?? 0);
  const counts = new Array<number>(Math.ceil((right - left) / BIN)).fill(0);
  for (const [start, end] of marks) {
    const first = Math.floor((toX(start) - left) / BIN);
    const last = Math.max(first, Math.ceil((toX(end) - left) / BIN) - 1);
    for (let bin = first; bin <= Math.min(last, counts.length - 1); bin++) counts[bin] = (counts[bin] ?? 0) + 1;
  }
  return counts;
}

function toBins(group: { marks: Mark[]; right: number }, toX: (time: number) => number, most: number): Dense[] {
  const { marks, right } = group;
  const [first] = marks;
  if (!first) return [];
  const left = toX(first[0]);
  if (marks.length === 1) return [{ left, width: right - left, count: 1, share: 1, label: first[2] }];
  const label = `${marks.length} marks, ${first[0].toFixed(2)} to ${marks.reduce((last, [, end]) => Math.max(last, end), 0).toFixed(2)} s`;
  const bins: Dense[] = [];
  for (const [i, count] of toCounts(group, toX).entries()) {
    const share = count ? LIGHTEST + ((DARKEST - LIGHTEST) * count) / most : 0;
    const before = bins.at(-1);
    if (before?.share === share) before.width += BIN;
    else bins.push({ left: left + i * BIN, width: BIN, count: marks.length, share, label });
  }
  const end = bins.at(-1);
  if (end) end.width = Math.max(1, right - end.left);
  return bins;
}
