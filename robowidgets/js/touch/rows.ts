import type { Box } from "../shared/box.ts";

export const GAP = 8;
const KINDS = /^(cliff|wheel|light|button|proximity|stall) /;
const NARROWEST = 92;
/**
 * Least width of a rectangle among a few, such as the bumpers of a robot: three stay side by side in a card of 260
 * pixels, four in one of 340.
 */
const NARROWEST_OF_FEW = 72;
const FEW = 4;
/** Height of a rectangle that is one of many. */
const LOW = 58;
const HIGH = 92;
/** If even that is too high for the room: a label and a state, without details. */
const LEAST = 31;
/** Below this width the words in a rectangle stand on separate lines. */
export const NARROW = 150;

/** Height of a rectangle among others, by its width. */
export function heightOf(width: number): number {
  return width < NARROW ? LOW + 20 : LOW;
}

/** Sensors in rows, from left to right: one row when there is room, else a new one for each kind, evenly filled. */
export function toRows(names: string[], columns: number): string[][] {
  if (names.length <= columns) return names.length ? [names] : [];
  const groups: string[][] = [];
  let last: string | undefined;
  for (const name of names) {
    const kind = KINDS.exec(name)?.[1] ?? "";
    if (kind === last) groups.at(-1)?.push(name);
    else groups.push([name]);
    last = kind;
  }
  return groups.flatMap((group) => {
    const count = Math.ceil(group.length / columns);
    const length = Math.ceil(group.length / count);
    return Array.from({ length: count }, (_, row) => group.slice(row * length, (row + 1) * length));
  });
}

/** Sensors in as few rows as there can be, evenly filled. */
function toFewRows(names: string[], columns: number): string[][] {
  const length = Math.ceil(names.length / Math.ceil(names.length / columns));
  return Array.from({ length: Math.ceil(names.length / length) }, (_, i) => names.slice(i * length, (i + 1) * length));
}

/**
 * A rectangle for each name, in rows that fill a width, from y downwards; and the lower end of the rows. A single row
 * is high. If the room is too low, there are fewer and lower rows.
 */
export function layRows(
  names: string[],
  width: number,
  y: number,
  room = Infinity,
): { boxes: Map<string, Box>; bottom: number } {
  const columnsOf = (narrowest: number) => Math.max(1, Math.floor((width + GAP) / (narrowest + GAP)));
  let rows = toRows(names, columnsOf(names.length > FEW ? NARROWEST : NARROWEST_OF_FEW));
  const longest = Math.max(...rows.map((row) => row.length));
  let height = rows.length > 1 || y > 0 ? heightOf((width + GAP) / longest - GAP) : HIGH;
  if (y + rows.length * (height + GAP) - GAP > room) {
    rows = toFewRows(names, columnsOf(NARROWEST_OF_FEW));
    height = Math.min(height, Math.max(LEAST, (room - y + GAP) / rows.length - GAP));
  }
  const boxes = new Map<string, Box>();
  rows.forEach((row, i) => {
    const each = (width - GAP * (row.length - 1)) / row.length;
    row.forEach((name, column) => {
      boxes.set(name, { x: column * (each + GAP), y: y + i * (height + GAP), width: each, height });
    });
  });
  return { boxes, bottom: y + rows.length * (height + GAP) - (rows.length ? GAP : 0) };
}
