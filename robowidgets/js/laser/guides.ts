import { toDegrees } from "../shared/format.ts";
import { type Box, type Projection, RIM_MARKS, type Rim, rimBox, toDirection } from "./projection.ts";
import { angleFrom, angleOf, indexAt, isFullCircle, type Sweep, spanOf } from "./scan.ts";

/** Distances of the range arcs in metres: the given ones, or `count` that divide the view in equal parts. */
export function arcDistances(asked: number[], count: number, viewRange: number): number[] {
  const arcs = asked.length ? [...asked].sort((a, b) => a - b) : divide(count, viewRange);
  return arcs.filter((distance) => distance <= viewRange * (1 + 1e-9));
}

function divide(count: number, whole: number): number[] {
  return Array.from({ length: count }, (_, i) => (whole * (i + 1)) / count);
}

/**
 * Indices of the rays at which radial lines stand: `count` of them, which divide the swept angle in equal parts, as
 * near as there is a ray. The first and the last ray are among them; on a full circle, where they meet, forward is.
 */
export function rayIndices(sweep: Sweep, count: number): number[] {
  if (sweep.count === 0 || count === 0) return [];
  if (count === 1) return [Math.floor((sweep.count - 1) / 2)];
  const isCircle = isFullCircle(sweep);
  const whole = isCircle ? (2 * Math.PI) / Math.abs(sweep.angleIncrement) : sweep.count;
  const first = isCircle ? indexAt(sweep, 0) : 0;
  const step = isCircle ? whole / count : (whole - 1) / (count - 1);
  const indices = Array.from({ length: count }, (_, i) => Math.round((first + i * step) % whole));
  return [...new Set(indices.map((index) => Math.min(sweep.count - 1, index)))];
}

export interface RayLabel extends Rim {
  index: number;
  angle: number;
  /** Angle over index, as a program writes it. */
  lines: [string, string];
}

const LABEL_GAP = 4;

/** Labels of the radial lines, outside the area. `measure` gives the width of the two lines in pixels. */
export function rayLabels(
  sweep: Sweep,
  indices: number[],
  forward: number,
  measure: (lines: [string, string]) => number,
): RayLabel[] {
  return indices.map((index) => {
    const angle = angleOf(sweep, index);
    const lines: [string, string] = [toDegrees(angle), `[${index}]`];
    const direction = toDirection(angle, forward);
    const halfWidth = measure(lines) / 2;
    const halfHeight = 15;
    const gap = RIM_MARKS + LABEL_GAP + Math.abs(direction.x) * halfWidth + Math.abs(direction.y) * halfHeight;
    return { index, angle, lines, direction, gap, halfWidth, halfHeight };
  });
}

export function overlaps(a: Box, b: Box, margin = 0): boolean {
  return (
    a.x < b.x + b.width + margin &&
    b.x < a.x + a.width + margin &&
    a.y < b.y + b.height + margin &&
    b.y < a.y + a.height + margin
  );
}

/** Drops every second label until none overlaps another; of a circle that is nearly closed first the last. */
export function thinLabels(projection: Projection, labels: RayLabel[]): RayLabel[] {
  const clash = (some: RayLabel[]) => {
    const boxes = some.map((label) => rimBox(projection, label));
    return boxes.some((box, i) => boxes.slice(i + 1).some((other) => overlaps(box, other, 2)));
  };
  let kept = labels;
  while (clash(kept)) {
    const open = kept.slice(0, -1);
    kept = clash(open) ? kept.filter((_, i) => i % 2 === 0) : open;
  }
  return kept;
}

const CELL = 6;

/** Which parts of the picture hold something that a label must not cover. */
export class Occupancy {
  readonly #columns: number;
  readonly #rows: number;
  readonly #cells: Uint8Array;

  constructor(width: number, height: number) {
    this.#columns = Math.ceil(width / CELL) + 1;
    this.#rows = Math.ceil(height / CELL) + 1;
    this.#cells = new Uint8Array(this.#columns * this.#rows);
  }

  mark(x: number, y: number): void {
    const [column, row] = [Math.floor(x / CELL), Math.floor(y / CELL)];
    if (column >= 0 && row >= 0 && column < this.#columns && row < this.#rows) {
      this.#cells[row * this.#columns + column] = 1;
    }
  }

  /** How many marked cells lie under a box. */
  count({ x, y, width, height }: Box): number {
    let found = 0;
    const last = { column: Math.floor((x + width) / CELL), row: Math.floor((y + height) / CELL) };
    for (let row = Math.max(0, Math.floor(y / CELL)); row <= Math.min(this.#rows - 1, last.row); row++) {
      for (
        let column = Math.max(0, Math.floor(x / CELL));
        column <= Math.min(this.#columns - 1, last.column);
        column++
      ) {
        found += this.#cells[row * this.#columns + column] as number;
      }
    }
    return found;
  }
}

export interface ArcLabel {
  distance: number;
  angle: number;
  box: Box;
}

const ARC_LABEL_HEIGHT = 14;
const ROBOT = 10;
const CANDIDATES = 48;
const LEFT_OF_FORWARD = 0.24;

/**
 * Places of the labels of the arcs: just inside each arc, left of forward, or elsewhere along it when a reading is
 * there. A label keeps its place as long as that is free, so that labels of a live picture do not jump. Without a free
 * place it is left out.
 *
 * @param lines angles of the radial lines
 * @param covered parts of the picture that something covers
 */
export function arcLabels(
  projection: Projection,
  sweep: Sweep,
  arcs: { distance: number; width: number }[],
  lines: number[],
  occupied: Occupancy,
  covered: Box[],
  previous: ArcLabel[],
): ArcLabel[] {
  const placed: ArcLabel[] = [];
  const { centerX, centerY } = projection;
  const robot = { x: centerX - ROBOT, y: centerY - ROBOT, width: 2 * ROBOT, height: 2 * ROBOT };
  const [from, to] = spanOf(sweep);
  const left = angleFrom(from, LEFT_OF_FORWARD);
  const preferred = left < to ? left : (from + to) / 2;
  const angles = Array.from({ length: CANDIDATES }, (_, i) => from + ((i + 0.5) / CANDIDATES) * (to - from)).sort(
    (a, b) => Math.abs(a - preferred) - Math.abs(b - preferred),
  );
  for (const { distance, width } of arcs) {
    const pixels = (distance / projection.viewRange) * projection.radius;
    const toLabel = (angle: number): ArcLabel => {
      const direction = toDirection(angle, projection.forward);
      const depth = (Math.abs(direction.x) * width + Math.abs(direction.y) * ARC_LABEL_HEIGHT) / 2 + 2;
      const x = centerX + direction.x * (pixels - depth);
      const y = centerY + direction.y * (pixels - depth);
      const box = { x: x - width / 2, y: y - ARC_LABEL_HEIGHT / 2, width, height: ARC_LABEL_HEIGHT };
      return { distance, angle, box };
    };
    const before = previous.find((label) => label.distance === distance);
    // Half the label's width must lie inside the swept angle; clear of the radial lines is better.
    const needed = (width / 2 + 3) / pixels;
    const inSweep = (angle: number) =>
      isFullCircle(sweep) || to - from < 2 * needed || (angle - from > needed && to - angle > needed);
    const isClear = (angle: number) =>
      lines.every((line) => Math.abs(Math.sin((angle - line) / 2)) * 2 * pixels > width / 3);
    const free = (label: ArcLabel) =>
      occupied.count(label.box) === 0 &&
      ![robot, ...covered, ...placed.map(({ box }) => box)].some((box) => overlaps(label.box, box));
    const within = angles.filter(inSweep);
    const stay = before && inSweep(before.angle) ? [before.angle] : [];
    const candidates = [...stay, ...within.filter(isClear), ...within].map(toLabel);
    const found = candidates.find(free);
    if (found) placed.push(found);
  }
  return placed;
}
