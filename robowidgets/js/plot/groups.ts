/** How a line is drawn. */
export interface Pen {
  width: number;
  dash: number[];
}

/** Told apart without colour, also where two lie over each other. */
const PENS: Pen[] = [
  { width: 1.75, dash: [] },
  { width: 1.25, dash: [2.5, 2] },
  { width: 1.25, dash: [7, 4] },
  { width: 1.25, dash: [8, 3, 2, 3] },
  { width: 1.25, dash: [14, 3] },
  { width: 1.25, dash: [3, 5] },
  { width: 1.25, dash: [10, 3, 2, 3, 2, 3] },
  { width: 2.5, dash: [2, 3] },
];

/** A line: its name, its place among all, and its pen. */
export interface Entry {
  name: string;
  index: number;
  pen: Pen;
}

/** The lines of one unit, which share a graph. */
export interface Group {
  unit: string;
  entries: Entry[];
}

/** Groups of lines by unit, in the order in which the lines came. */
export function toGroups(names: string[], units: Record<string, string>): Group[] {
  const groups = new Map<string, Group>();
  for (const [index, name] of names.entries()) {
    const unit = Object.hasOwn(units, name) ? (units[name] as string) : "";
    const group = groups.get(unit) ?? { unit, entries: [] };
    const pen = PENS[group.entries.length % PENS.length] as Pen;
    groups.set(unit, { unit, entries: [...group.entries, { name, index, pen }] });
  }
  return [...groups.values()];
}

/** A number of at most so many digits, with a real minus sign: "0.3", "−12.5", "1.2e+9". */
export function toDigits(value: number, digits: number): string {
  if (Number.isNaN(value)) return "NaN";
  return String(Number(value.toPrecision(digits))).replace(/-/g, "\u2212");
}
