import { toCount, toDegrees } from "../shared/format.ts";
import { yawOf } from "./text.ts";
import { canUnfold, elementsOf, type Field, summaryOf, textsOf } from "./tree.ts";

/** Lines up to which messages within the message are unfolded by default. */
const ROOM = 40;
/** Elements of an array that stand together. */
const PAGE = 32;

/** A line of the tree: a field, a part of a long array, or a text about missing parts. */
export interface TreeLine {
  /** Its name among all lines. */
  key: string;
  depth: number;
  field: Field | null;
  /** Label of a line without a field. */
  label: string;
  /** Null for a line that cannot be unfolded. */
  isOpen: boolean | null;
  /** The source of a value that is computed from other fields, or "" for a value of the message. */
  derived: string;
  /** The path that is requested from Python when the line is chosen, or "". */
  asks: string;
}

/** The lines on show, from top to bottom. @param folds the parts that the user unfolded or folded, by key */
export function toTreeLines(fields: readonly Field[], folds: Record<string, boolean>): TreeLine[] {
  const open = openAtFirst(fields);
  const lines: TreeLine[] = [];
  const isOpen = (key: string) => folds[key] ?? open.has(key);
  const add = (field: Field, depth: number) => {
    const { path, node } = field;
    const unfolds = canUnfold(field);
    lines.push({ ...PLAIN, key: path, depth, field, isOpen: unfolds ? isOpen(path) : null });
    if (!unfolds || !isOpen(path)) return;
    if (node.kind === "numbers")
      addPages(path, depth + 1, summaryOf(field).count, (from, to) => elementsOf(field, from, to));
    else if (node.kind === "texts") addTexts(field, depth + 1);
    else if (!field.children) lines.push(missing(path, depth + 1, "loading \u2026"));
    else {
      addAll(field.children, depth + 1, path, node.more ?? 0);
      const turn = yawOf(field.children);
      for (const label of turn ? (["roll", "pitch"] as const) : []) {
        const derived = toDegrees(turn?.[label] ?? NaN);
        lines.push({ ...PLAIN, key: `${path} ${label}`, depth: depth + 1, label, derived });
      }
    }
  };
  const addAll = (children: readonly Field[], depth: number, path: string, more: number) => {
    addPages(path, depth, children.length, (from, to) => children.slice(from, to), 3 * PAGE);
    if (more) lines.push({ ...missing(path, depth, `${toCount(more)} more`), asks: path });
  };
  const addPages = (
    path: string,
    depth: number,
    count: number,
    slice: (from: number, to: number) => readonly Field[],
    most = PAGE,
  ) => {
    if (count <= most) {
      const shown = slice(0, count);
      for (const field of shown) add(field, depth);
      if (shown.length < count) lines.push(missing(path, depth, `more than the page gets: ${path} in Python has all`));
      return;
    }
    const shown = slice(0, count);
    if (!shown.length) {
      lines.push(missing(path, depth, `more than the page gets: ${path} in Python has all`));
      return;
    }
    for (let from = 0; from < count; from += PAGE) {
      const to = Math.min(from + PAGE, count);
      const key = `${path}[${from}:${to}]`;
      lines.push({ ...PLAIN, key, depth, label: `[${from}:${to}]`, isOpen: isOpen(key) });
      if (isOpen(key)) for (const field of shown.slice(from, to)) add(field, depth + 1);
    }
  };
  const addTexts = (field: Field, depth: number) => {
    const texts = textsOf(field);
    for (const text of texts) add(text, depth);
    const left = (field.value as [number])[0] - texts.length;
    if (left > 0) lines.push(missing(field.path, depth, `${toCount(left)} more, in Python`));
  };
  for (const field of fields) add(field, 0);
  return lines;
}

const PLAIN = { field: null, label: "", isOpen: null, derived: "", asks: "" };

function missing(path: string, depth: number, label: string): TreeLine {
  return { ...PLAIN, key: `${path} \u2026`, depth, label };
}

/** The paths that are unfolded at first: those nearest to the root, as long as there is room. */
function openAtFirst(fields: readonly Field[]): Set<string> {
  const open = new Set<string>();
  let room = ROOM - fields.length;
  let level = fields;
  while (level.length) {
    const next: Field[] = [];
    for (const field of level) {
      const { children, node } = field;
      if (!children?.length || (node.more ?? 0) > 0 || children.length > room) continue;
      room -= children.length;
      open.add(field.path);
      next.push(...children);
    }
    level = next;
  }
  return open;
}
