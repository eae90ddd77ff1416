import { type Box, holds, type Point } from "../shared/box.ts";

/** A card on the screen: its name in an arrangement, and its kind, such as "laser". */
export interface CardName {
  name: string;
  kind: string;
}

/** A card or a split of the screen. Widths are shares of a row, heights are pixels; both may be absent. */
export interface Part {
  card?: string;
  row?: Part[];
  column?: Part[];
  width?: number | undefined;
  height?: number | undefined;
}

/** A part as Python stores it: a card without sizes is its name. */
export type StoredPart = string | { [K in keyof Part]: Part[K] extends Part[] | undefined ? StoredPart[] : Part[K] };

export type Side = "left" | "right" | "above" | "below";
type Way = "row" | "column";

/** A place for a card: at a side of another card, or of the whole screen if the target is null. */
export interface Zone {
  target: string | null;
  side: Side;
}

/** The edge between two neighbours of a split: the indices that lead to the split, and the index of the first one. */
export interface Edge {
  path: number[];
  index: number;
  way: Way;
}

export const GAP = 4;
export const TWELFTHS = 12;
/** Heights are multiples of it, in pixels. */
export const STEP = 24;
/** Pixels at the sides of the screen within which a card is dropped next to all others. */
const RIM = 20;
/** Most cards side by side, unless the user puts more there. */
const MOST_IN_ROW = 3;

/** The least width and height of a card, so that it can show its numbers. */
const LEAST: Record<string, [number, number]> = {
  laser: [260, 260],
  sonar: [260, 260],
  scanogram: [320, 200],
  speed: [200, 120],
  touch: [176, 110],
  image: [220, 200],
  cloud: [260, 240],
  plot: [260, 180],
  path: [150, 160],
  simulator: [240, 200],
  program: [260, 160],
  machine: [240, 290],
  lines: [260, 44],
};
const LEAST_OF_OTHERS: [number, number] = [220, 120];

/** Cards whose pictures have no height of their own: they take the rest of a column. */
const FILLING = new Set(["laser", "sonar", "scanogram", "image", "cloud", "plot", "path", "simulator", "machine"]);
/** Cards that end where their lines end. */
const FITTING = new Set(["lines", "program"]);

export const fills = (kind: string): boolean => FILLING.has(kind);
export const leastOf = (kind: string): [number, number] => LEAST[kind] ?? LEAST_OF_OTHERS;

export const partsOf = (part: Part): Part[] => part.row ?? part.column ?? [];
const wayOf = (part: Part): Way => (part.row ? "row" : "column");
const sizesOf = ({ width, height }: Part): Part => ({ ...(width && { width }), ...(height && { height }) });
const split = (way: Way, parts: Part[], like: Part = {}): Part =>
  way === "row" ? { row: parts, ...sizesOf(like) } : { column: parts, ...sizesOf(like) };
const isAcross = (side: Side) => side === "left" || side === "right";
const spliced = (parts: readonly Part[], at: number, added: Part) => [...parts.slice(0, at), added, ...parts.slice(at)];
const isBefore = (side: Side) => side === "left" || side === "above";

/** Reads a stored part. */
export function read(stored: StoredPart): Part {
  if (typeof stored === "string") return { card: stored };
  const { row, column, ...rest } = stored;
  if (row) return { ...rest, row: row.map(read) };
  return column ? { ...rest, column: column.map(read) } : rest;
}

/** The part for Python. */
export function pack(part: Part): StoredPart {
  if (part.card !== undefined) return part.width || part.height ? { card: part.card, ...sizesOf(part) } : part.card;
  const parts = partsOf(part).map(pack);
  return wayOf(part) === "row" ? { row: parts, ...sizesOf(part) } : { column: parts, ...sizesOf(part) };
}

/** The names of the cards, in the order of reading. */
export function namesOf(part: Part): string[] {
  return part.card === undefined ? partsOf(part).flatMap(namesOf) : [part.card];
}

/** A tree without empty splits, splits of one part, and splits within a split of the same way. */
function tidied(part: Part): Part | null {
  if (part.card !== undefined) return part;
  const way = wayOf(part);
  const parts = partsOf(part).flatMap((one) => {
    const inner = tidied(one);
    if (!inner) return [];
    return inner[way] && inner.card === undefined ? partsOf(inner) : [inner];
  });
  const [first, second] = parts;
  if (!first) return null;
  // Its size in the split around it is the size of its only part.
  return second ? split(way, parts, part) : bare(first, part);
}

/** A part with the sizes of the part that it replaces. */
function bare(part: Part, { width, height }: Part): Part {
  const { width: _width, height: _height, ...rest } = part;
  return { ...rest, ...sizesOf({ width, height }) };
}

/** The tree with other cards at its leaves; a card that becomes null is left out. */
function mapped(part: Part, change: (leaf: Part) => Part | null): Part | null {
  if (part.card !== undefined) return change(part);
  const parts = partsOf(part).flatMap((one) => mapped(one, change) ?? []);
  return split(wayOf(part), parts, part);
}

export function without(tree: Part, name: string): Part | null {
  const rest = mapped(tree, (leaf) => (leaf.card === name ? null : leaf));
  return rest && tidied(rest);
}

/**
 * The tree of the cards that exist now. Cards that it does not name stand below, side by side. A topic in the tree
 * without the name of a widget means its first card.
 */
export function present(tree: Part, cards: readonly CardName[]): Part | null {
  const left = new Set(cards.map(({ name }) => name));
  const take = (leaf: Part) => {
    const found = left.has(leaf.card ?? "") ? leaf.card : [...left].find((name) => name.startsWith(`${leaf.card} as `));
    return found !== undefined && left.delete(found) ? { ...leaf, card: found } : null;
  };
  const pruned = mapped(tree, take);
  const there = pruned && tidied(pruned);
  const more = rowsOf([...left].map((card) => ({ card })));
  return tidied({ column: [...(there ? [there] : []), ...more] });
}

/** Rows of a few parts each. */
function rowsOf(parts: Part[], most = MOST_IN_ROW): Part[] {
  const rows = Math.ceil(parts.length / most);
  return Array.from({ length: rows }, (_, i) => ({
    row: parts.slice(Math.ceil((i * parts.length) / rows), Math.ceil(((i + 1) * parts.length) / rows)),
  }));
}

/** The tree with a part at a place; unchanged if the target is not in it. */
export function inserted(tree: Part, added: Part, { target, side }: Zone): Part {
  const way: Way = isAcross(side) ? "row" : "column";
  const put = (part: Part): Part => {
    const plain = bare(part, {});
    return split(way, isBefore(side) ? [added, plain] : [plain, added], part);
  };
  const within = (part: Part): Part => {
    if (part.card !== undefined) return part.card === target ? put(part) : part;
    const parts = partsOf(part);
    const at = parts.findIndex((one) => one.card === target);
    if (at < 0 || wayOf(part) !== way) return split(wayOf(part), parts.map(within), part);
    return split(way, spliced(parts, isBefore(side) ? at : at + 1, added), part);
  };
  const whole = target === null ? put(tree) : within(tree);
  return tidied(whole) ?? whole;
}

/** The tree after a card has moved to a place, without the sizes that it had. */
export function moved(tree: Part, name: string, zone: Zone): Part {
  const rest = without(tree, name);
  if (!rest || zone.target === name) return tree;
  return inserted(rest, { card: name }, zone);
}

/** The indices that lead to a card; null if it is not in the tree. */
export function pathTo(tree: Part, name: string): number[] | null {
  if (tree.card !== undefined) return tree.card === name ? [] : null;
  for (const [i, part] of partsOf(tree).entries()) {
    const path = pathTo(part, name);
    if (path) return [i, ...path];
  }
  return null;
}

function at(tree: Part, path: readonly number[]): Part {
  return path.reduce((part, i) => partsOf(part)[i] ?? part, tree);
}

function replaced(tree: Part, path: readonly number[], change: (part: Part) => Part): Part {
  const [i, ...rest] = path;
  if (i === undefined) return change(tree);
  const parts = partsOf(tree).map((part, j) => (i === j ? replaced(part, rest, change) : part));
  return split(wayOf(tree), parts, tree);
}

/** The tree after a card has gone one place to a side, by a key; the same tree if it cannot go there. */
export function stepped(tree: Part, name: string, side: Side): Part {
  const path = pathTo(tree, name);
  if (!path?.length) return tree;
  const way: Way = isAcross(side) ? "row" : "column";
  const by = isBefore(side) ? -1 : 1;
  const last = path.length - 1;
  for (let depth = last; depth >= 0; depth--) {
    const [outer, i] = [path.slice(0, depth), path[depth] ?? 0];
    const around = at(tree, outer);
    if (wayOf(around) !== way) continue;
    const parts = partsOf(around);
    if (depth < last) {
      // It leaves the split in which it stands, and stands next to that.
      const [first] = namesOf(parts[i] ?? {}).filter((one) => one !== name);
      if (first === undefined) continue;
      const put = (part: Part) => split(way, spliced(partsOf(part), by < 0 ? i : i + 1, { card: name }), part);
      const cut = replaced(
        tree,
        [...outer, i],
        (part) => mapped(part, (one) => (one.card === name ? null : one)) ?? {},
      );
      const whole = replaced(cut, outer, put);
      return tidied(whole) ?? whole;
    }
    const next = parts[i + by];
    if (!next) continue;
    if (next.card !== undefined) {
      const swap = (part: Part) => {
        const swapped = [...partsOf(part)];
        [swapped[i], swapped[i + by]] = [next, parts[i] ?? next];
        return split(way, swapped, part);
      };
      return replaced(tree, outer, swap);
    }
    // Into a split of the other way, at its first place.
    const [first] = namesOf(next);
    return moved(tree, name, { target: first ?? null, side: way === "row" ? "above" : "left" });
  }
  const edge = moved(tree, name, { target: null, side });
  return isSame(edge, tree) ? tree : edge;
}

const ORDINALS = ["first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth"];
const NUMBERS = ["no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine"];
const ordinal = (i: number) => ORDINALS[i] ?? `number ${i + 1}`;

/** The place of a card in words: "second column, first of two". */
export function placeWords(tree: Part, name: string): string {
  const path = pathTo(tree, name) ?? [];
  const words = path.map((i, depth) => {
    const around = at(tree, path.slice(0, depth));
    if (wayOf(around) === "row") return `${ordinal(i)} column`;
    const count = partsOf(around).length;
    return depth === path.length - 1 ? `${ordinal(i)} of ${NUMBERS[count] ?? count}` : `${ordinal(i)} row`;
  });
  return words.join(", ") || "alone";
}

/** The shares of the parts of a row; a part without a width has the mean of the others. */
export function sharesOf(parts: readonly Part[]): number[] {
  const widths = parts.flatMap(({ width }) => width ?? []);
  const mean = widths.length ? widths.reduce((sum, width) => sum + width, 0) / widths.length : 1;
  const shares = parts.map(({ width }) => width ?? mean);
  const sum = shares.reduce((total, share) => total + share, 0);
  return shares.map((share) => share / sum);
}

/** Shares as whole twelfths, which have the sum 12 unless there are more parts. */
export function toTwelfths(shares: readonly number[]): number[] {
  const widths = shares.map((share) => Math.max(1, Math.floor(share * TWELFTHS + 1e-9)));
  const lacks = () => TWELFTHS - widths.reduce((sum, width) => sum + width, 0);
  while (lacks() > 0) {
    const behind = shares.map((share, i) => share * TWELFTHS - (widths[i] ?? 0));
    const most = behind.indexOf(Math.max(...behind));
    widths[most] = (widths[most] ?? 0) + 1;
  }
  while (lacks() < 0 && Math.max(...widths) > 1) {
    const most = widths.indexOf(Math.max(...widths));
    widths[most] = (widths[most] ?? 0) - 1;
  }
  return widths;
}

/** The kind of a card by its name. */
export type KindOf = (name: string) => string;

/** The least width and height of a part. */
export function leastSize(part: Part, kindOf: KindOf): [number, number] {
  if (part.card !== undefined) return leastOf(kindOf(part.card));
  const sizes = partsOf(part).map((one) => leastSize(one, kindOf));
  const sum = (axis: 0 | 1) => sizes.reduce((total, size) => total + size[axis], 0) + GAP * (sizes.length - 1);
  const most = (axis: 0 | 1) => Math.max(0, ...sizes.map((size) => size[axis]));
  return part.row ? [sum(0), most(1)] : [most(0), sum(1)];
}

/** Returns true if a part takes the rest of a column. */
export function takesRest(part: Part, kindOf: KindOf): boolean {
  if (part.height) return false;
  return part.card === undefined ? partsOf(part).some((one) => takesRest(one, kindOf)) : fills(kindOf(part.card));
}

const toSteps = (height: number) => Math.max(STEP, Math.round(height / STEP) * STEP);

/**
 * The tree after an edge has been dragged.
 * @param by pixels to the right or down
 * @param sizes of the parts along the split, in pixels, as they were
 */
export function resized(tree: Part, { path, index, way }: Edge, by: number, sizes: number[], kindOf: KindOf): Part {
  const change = (part: Part): Part => {
    const parts = partsOf(part);
    const [one, next] = [parts[index], parts[index + 1]];
    if (!one || !next) return part;
    const [before = 0, after = 0] = [sizes[index], sizes[index + 1]];
    if (way === "row") {
      const total = sizes.reduce((sum, size) => sum + size, 0);
      const unit = total / TWELFTHS;
      const widths = toTwelfths(sizes.map((size) => size / total));
      const [mine = 1, theirs = 1] = [widths[index], widths[index + 1]];
      const least = (some: Part) => Math.max(1, Math.ceil(leastSize(some, kindOf)[0] / unit - 0.5));
      const low = Math.min(least(one), mine) - mine;
      const high = theirs - Math.min(least(next), theirs);
      const shift = Math.min(high, Math.max(low, Math.round(by / unit)));
      widths[index] = mine + shift;
      widths[index + 1] = theirs - shift;
      return split(
        way,
        parts.map((some, i) => ({ ...some, width: widths[i] })),
        part,
      );
    }
    // The part that takes the rest of the column has no height.
    const changesNext = takesRest(one, kindOf) && !takesRest(next, kindOf);
    const [changed, from, shift] = changesNext ? [next, after, -by] : [one, before, by];
    const least = Math.ceil(leastSize(changed, kindOf)[1] / STEP) * STEP;
    const height = Math.max(least, toSteps(from + shift));
    const sized = parts.map((some) => (some === changed ? { ...some, height } : some));
    return split(way, sized, part);
  };
  return replaced(tree, path, change);
}

/** The tree after a card has become wider by twelfths, or higher by steps, by a key. */
export function grown(tree: Part, name: string, side: Side, boxes: ReadonlyMap<string, Box>, kindOf: KindOf): Part {
  const path = pathTo(tree, name);
  const way: Way = isAcross(side) ? "row" : "column";
  for (let depth = (path?.length ?? 0) - 1; path && depth >= 0; depth--) {
    const [outer, i] = [path.slice(0, depth), path[depth] ?? 0];
    const around = at(tree, outer);
    if (wayOf(around) !== way) continue;
    const parts = partsOf(around);
    const sizes = parts.map((part) => boxOf(part, boxes)?.[way === "row" ? "width" : "height"] ?? 0);
    const unit = way === "row" ? sizes.reduce((sum, size) => sum + size, 0) / TWELFTHS : STEP;
    const by = (side === "right" || side === "below" ? 1 : -1) * unit;
    const isLast = i === parts.length - 1;
    return resized(tree, { path: outer, index: isLast ? i - 1 : i, way }, isLast ? -by : by, sizes, kindOf);
  }
  return tree;
}

/** The box around all cards of a part; null without any. */
export function boxOf(part: Part, boxes: ReadonlyMap<string, Box>): Box | null {
  const all = namesOf(part).flatMap((name) => boxes.get(name) ?? []);
  if (!all.length) return null;
  const [x, y] = [Math.min(...all.map((box) => box.x)), Math.min(...all.map((box) => box.y))];
  const right = Math.max(...all.map((box) => box.x + box.width));
  const bottom = Math.max(...all.map((box) => box.y + box.height));
  return { x, y, width: right - x, height: bottom - y };
}

/** The edge in the gap at a point; null without one. */
export function edgeAt(tree: Part, boxes: ReadonlyMap<string, Box>, point: Point, path: number[] = []): Edge | null {
  const [parts, way] = [partsOf(tree), wayOf(tree)];
  const around = boxOf(tree, boxes);
  if (!around || !holds(around, point)) return null;
  for (const [i, part] of parts.entries()) {
    const [box, next] = [boxOf(part, boxes), boxOf(parts[i + 1] ?? {}, boxes)];
    if (box && holds(box, point)) return edgeAt(part, boxes, point, [...path, i]);
    if (!box || !next) continue;
    const [end, start, here] =
      way === "row" ? [box.x + box.width, next.x, point.x] : [box.y + box.height, next.y, point.y];
    if (start >= end && here >= end && here <= start) return { path, index: i, way };
  }
  return null;
}

/** An edge with its arrangement, its line on the screen, and the sizes of all parts along its split. */
export function edgeBox(tree: Part, edge: Edge, boxes: ReadonlyMap<string, Box>) {
  const { path, index, way } = edge;
  const parts = partsOf(at(tree, path));
  const all = parts.map((part) => boxOf(part, boxes) ?? { x: 0, y: 0, width: 0, height: 0 });
  const around = boxOf({ row: parts }, boxes) ?? { x: 0, y: 0, width: 0, height: 0 };
  const [one, next] = [all[index], all[index + 1]];
  if (!one || !next) return null;
  const line: Box =
    way === "row"
      ? { x: (one.x + one.width + next.x) / 2 - 1.5, y: around.y, width: 3, height: around.height }
      : { x: around.x, y: (one.y + one.height + next.y) / 2 - 1.5, width: around.width, height: 3 };
  return { ...edge, tree, line, sizes: all.map((box) => (way === "row" ? box.width : box.height)) };
}

/** The place for a card that is dragged to a point; null over itself, and far outside of the screen. */
export function zoneAt(boxes: ReadonlyMap<string, Box>, dragged: string, point: Point): Zone | null {
  const around = boxOf({ row: [...boxes.keys()].map((card) => ({ card })) }, boxes);
  if (!around) return null;
  const far: [Side, number][] = [
    ["left", point.x - around.x],
    ["right", around.x + around.width - point.x],
    ["above", point.y - around.y],
    ["below", around.y + around.height - point.y],
  ];
  const [rim] = far.filter(([, distance]) => distance < RIM).sort((a, b) => a[1] - b[1]);
  if (rim) return far.every(([, distance]) => distance > -3 * RIM) ? { target: null, side: rim[0] } : null;
  for (const [name, box] of boxes) {
    if (!holds(box, point)) continue;
    if (name === dragged) return null;
    const [across, down] = [(point.x - box.x) / box.width - 0.5, (point.y - box.y) / box.height - 0.5];
    const side = Math.abs(across) > Math.abs(down) ? (across < 0 ? "left" : "right") : down < 0 ? "above" : "below";
    return { target: name, side };
  }
  return null;
}

/** The tree of cards by their boxes on a screen that was not arranged by hand. */
export function fromBoxes(boxes: ReadonlyMap<string, Box>, kindOf: KindOf): Part | null {
  const names = [...boxes.keys()];
  const [only] = names;
  if (only === undefined) return null;
  if (names.length === 1) return { card: only };
  for (const way of ["row", "column"] as const) {
    const groups = cut(boxes, way);
    if (groups.length < 2) continue;
    const parts = groups.flatMap((group) => fromBoxes(group, kindOf) ?? []);
    const all = groups.map((group) => boxOf({ row: [...group.keys()].map((card) => ({ card })) }, group));
    if (way === "row") {
      const total = all.reduce((sum, box) => sum + (box?.width ?? 0), 0);
      const widths = toTwelfths(all.map((box) => (box?.width ?? 0) / total));
      return { row: parts.map((part, i) => ({ ...part, width: widths[i] })) };
    }
    const heights = all.map((box) => box?.height ?? 0);
    const highest = Math.max(...heights.filter((_, i) => takesRest(parts[i] ?? {}, kindOf)));
    const takesAll = heights.findIndex((height, i) => height === highest && takesRest(parts[i] ?? {}, kindOf));
    const isLow = (part: Part) => part.card !== undefined && FITTING.has(kindOf(part.card));
    return {
      column: parts.map((part, i) =>
        i === takesAll || isLow(part) ? part : { ...part, height: toSteps(heights[i] ?? STEP) },
      ),
    };
  }
  // No line separates them: they stand one below the other.
  return { column: names.map((card) => ({ card })) };
}

/** Groups of boxes, in their order along a split, which no box of another group overlaps. */
function cut(boxes: ReadonlyMap<string, Box>, way: Way): Map<string, Box>[] {
  const extent = ({ x, y, width, height }: Box) =>
    (way === "row" ? [x, x + width] : [y, y + height]) as [number, number];
  const ordered = [...boxes].sort(([, a], [, b]) => extent(a)[0] - extent(b)[0]);
  const groups: Map<string, Box>[] = [];
  let end = -Infinity;
  for (const [name, box] of ordered) {
    const [from, to] = extent(box);
    if (from >= end - 1) groups.push(new Map());
    groups.at(-1)?.set(name, box);
    end = Math.max(end, to);
  }
  return groups;
}

export const PRESETS = ["laser", "camera", "plots"] as const;
export type Preset = (typeof PRESETS)[number];

const LARGE: Record<Preset, string[]> = { laser: ["laser", "sonar"], camera: ["image", "cloud"], plots: ["plot"] };
/** Cards that need the width of the screen. */
const WIDE = new Set(["scanogram", "plot", "wires", "lines"]);
/** Cards that stand at the side of a large one only if no others do. */
const LARGER = new Set(["program", "machine", "simulator", "image", "cloud", "laser", "sonar", "message", "events"]);
const SCANOGRAM_HEIGHT = 240;
/** Height of a large card above others. */
const MAIN_HEIGHT = 456;

/** The arrangement of a preset; null if no card is of its kind. */
export function presetOf(preset: Preset, cards: readonly CardName[]): Part | null {
  const isLarge = ({ kind }: CardName) => LARGE[preset].includes(kind);
  const large = cards.filter(isLarge);
  const [first] = large;
  if (!first || cards.length < 2) return null;
  const toLeaf = ({ name, kind }: CardName): Part =>
    kind === "scanogram" ? { card: name, height: SCANOGRAM_HEIGHT } : { card: name };
  const rest = cards.filter((card) => (preset === "plots" ? !isLarge(card) : card !== first));
  const [wide, others] = [rest.filter(({ kind }) => WIDE.has(kind)), rest.filter(({ kind }) => !WIDE.has(kind))];
  if (preset === "plots") {
    return tidied({ column: [...large.map(toLeaf), ...rowsOf(others.map(toLeaf), 4), ...wide.map(toLeaf)] });
  }
  const small = others.filter(({ kind }) => !LARGER.has(kind));
  // A large card is lower above others, and has room for fewer at its side.
  const most = wide.length || others.length > MOST_IN_ROW ? MOST_IN_ROW - 1 : MOST_IN_ROW;
  const atSide = small.length ? small.slice(0, most) : others.slice(0, 1);
  const side = atSide.map(toLeaf);
  const below = [...rowsOf(others.filter((card) => !atSide.includes(card)).map(toLeaf)), ...wide.map(toLeaf)];
  const [single, scanogram] = below;
  if (single?.row?.length === 1 && scanogram?.height) {
    // A card alone in its row would be too wide.
    const parts = [bare(scanogram, { width: 8 }), ...single.row.map((part) => bare(part, { width: 4 }))];
    below.splice(0, 2, { row: parts, height: SCANOGRAM_HEIGHT });
  }
  const size = below.length ? { height: MAIN_HEIGHT } : {};
  const main: Part = side.length
    ? {
        row: [
          { card: first.name, width: 8 },
          { column: side, width: 4 },
        ],
        ...size,
      }
    : { card: first.name, ...size };
  return tidied({ column: [main, ...below] });
}

export const isSame = (a: Part | null, b: Part | null): boolean =>
  JSON.stringify(a && pack(a)) === JSON.stringify(b && pack(b));

const PLAIN = /^[\w/.~ ,-]*$/;

/** Python's text of a value: texts, numbers, lists and dictionaries. */
function toPython(value: unknown): string {
  if (Array.isArray(value)) return `[${value.map(toPython).join(", ")}]`;
  if (value !== null && typeof value === "object") {
    return `{${Object.entries(value)
      .map(([name, one]) => `"${name}": ${toPython(one)}`)
      .join(", ")}}`;
  }
  if (typeof value === "string" && !PLAIN.test(value)) return JSON.stringify(value);
  return typeof value === "string" ? `"${value}"` : String(value);
}

/** Code that gives a program this arrangement. */
export function toCode(tree: Part, topics: readonly unknown[]): string {
  const parts = [
    ...(topics.length ? [`    "topics": ${toPython(topics)},`] : []),
    `    "cards": ${toPython(pack(tree))},`,
  ];
  return `arrangement = {\n${parts.join("\n")}\n}\n`;
}
