import { type Box, overlaps } from "../shared/box.ts";
import { type AngleUnit, toAngle } from "../shared/format.ts";
import { angleFrom, angleOf, indexAt, isFullCircle, type Sweep, spanOf } from "../shared/frames/scan.ts";
import type { Occupancy } from "../shared/occupancy.ts";
import { heightOf, type Projection, RIM_MARKS, type Rim, rimBox, sweepRim, toDirection } from "../shared/projection.ts";
import { ticks } from "../shared/ticks.ts";
import type { ToShown } from "./mount.ts";

/**
 * Distances of the range arcs in metres: the given ones; or `count` that divide the view in equal parts; or, without a
 * count, two to six at steps of 1, 2 or 5.
 */
export function arcDistances(asked: number[], count: number | null, viewRange: number): number[] {
  const arcs = asked.length ? [...asked].sort((a, b) => a - b) : divide(count, viewRange);
  return arcs.filter((distance) => distance <= viewRange * (1 + 1e-9));
}

const USUAL_ARCS = 4;

function divide(count: number | null, whole: number): number[] {
  if (count === null) return ticks(0, whole, USUAL_ARCS).slice(1);
  return Array.from({ length: count }, (_, i) => (whole * (i + 1)) / count);
}

/** Fewest and most radial lines without a count. */
const [FEWEST_LINES, MOST_LINES] = [6, 12];
const ROUND_STEPS = [45, 30, 20, 15, 10, 5, 2, 1, 0.5, 0.2, 0.1].map((degrees) => (degrees * Math.PI) / 180);

/**
 * Indices of the rays at which radial lines stand, in the order of the rays.
 *
 * @param angles radians; each line stands at the closest ray, or is left out if no ray is close
 * @param count instead of angles: so many lines divide the swept angle in equal parts, ends included, a full circle
 * from forward. Without a count they stand at equal angles from forward, a round number of degrees apart where rays
 * are dense enough, and at both ends.
 */
export function rayIndices(sweep: Sweep, angles: number[], count: number | null): number[] {
  if (sweep.count === 0) return [];
  let indices: number[];
  if (angles.length) indices = angles.map((angle) => indexAt(sweep, angle));
  else if (count === null) indices = linesFromForward(sweep);
  else indices = equalParts(sweep, count);
  return [...new Set(indices)].filter((index) => index >= 0).sort((a, b) => a - b);
}

function equalParts(sweep: Sweep, count: number): number[] {
  const forward = indexAt(sweep, 0);
  if (count === 1) return [forward < 0 ? Math.floor((sweep.count - 1) / 2) : forward];
  const isCircle = isFullCircle(sweep);
  const whole = isCircle ? raysOfTurn(sweep) : sweep.count;
  const step = isCircle ? whole / count : (whole - 1) / (count - 1);
  // A line that is about ahead stands exactly ahead, and the others keep their distances.
  const first = isCircle ? forward : forward - Math.round(forward / step) * step;
  const shift = isCircle || (forward >= 0 && Math.abs(first) <= Math.max(0.5, step / 20)) ? first : 0;
  const last = sweep.count - 1;
  return Array.from({ length: count }, (_, i) => {
    if (isCircle) return Math.min(last, Math.round((shift + i * step) % whole));
    return i === 0 ? 0 : i === count - 1 ? last : Math.round(shift + i * step);
  });
}

function linesFromForward(sweep: Sweep): number[] {
  const last = sweep.count - 1;
  const first = Math.max(0, indexAt(sweep, 0));
  if (isFullCircle(sweep)) {
    const turn = raysOfTurn(sweep);
    const step = stepOf(sweep, [turn]);
    const lines = Array.from({ length: Math.round(turn / step) }, (_, i) => Math.round((first + i * step) % turn));
    return lines.map((index) => Math.min(last, index));
  }
  const step = stepOf(sweep, [first, last - first]);
  const lines = Array.from({ length: 2 * MOST_LINES + 1 }, (_, i) => Math.round(first + (i - MOST_LINES) * step));
  return [0, ...lines.filter((index) => index > 0 && index < last), last];
}

/**
 * Rays from one line to the next: a round number of degrees, if possible one at which a line meets the ends as well.
 *
 * @param sides rays from forward to each end, or of a full turn
 */
function stepOf({ angleIncrement }: Sweep, sides: number[]): number {
  const whole = sides.reduce((sum, side) => sum + side, 0);
  const meetsEnds = (step: number) => sides.every((side) => Math.abs(side - Math.round(side / step) * step) <= 1);
  const round = ROUND_STEPS.map((angle) => angle / Math.abs(angleIncrement)).filter(
    (step) => whole / step > FEWEST_LINES - 0.5 && whole / step < MOST_LINES && isOnRays(step),
  );
  const fits = (step: number) => Math.abs(whole / step - (FEWEST_LINES + MOST_LINES) / 2);
  if (round.length) return round.find(meetsEnds) ?? (round.sort((a, b) => fits(a) - fits(b))[0] as number);
  const least = Math.max(1, Math.ceil(whole / MOST_LINES));
  const inRays = Array.from({ length: Math.max(1, Math.floor(whole / 4) - least + 1) }, (_, i) => least + i);
  return inRays.find((step) => sides.every((side) => side % step === 0)) ?? least;
}

/** Returns true if lines that are so many rays apart stand at equal angles, although each stands at a ray. */
function isOnRays(rays: number): boolean {
  return rays >= 8 || Math.abs(rays - Math.round(rays)) < 0.02;
}

/** Rays in a full turn. */
function raysOfTurn({ angleIncrement }: Sweep): number {
  return (2 * Math.PI) / Math.abs(angleIncrement);
}

export interface RayLabel extends Rim {
  index: number;
  angle: number;
  /** True for a label ahead or at an end of the sweep: it is kept if room is short. */
  isFixed: boolean;
  /** Angle over index, as a program writes it. */
  lines: [string, string];
}

const LABEL_GAP = 1;
/** Pixels of a letter of a label, about. */
const LETTER = 7;

/**
 * Labels of the radial lines, outside the area.
 *
 * @param measure gives the width of the two lines in pixels
 * @param unit in which the angle is shown
 * @param toShown converts to the angle on show
 */
export function rayLabels(
  sweep: Sweep,
  indices: number[],
  forward: number,
  measure: (lines: [string, string]) => number,
  unit: AngleUnit = "deg",
  toShown: ToShown = (angle) => angle,
): RayLabel[] {
  const ends = isFullCircle(sweep) ? [] : [0, sweep.count - 1];
  const fixed = [indexAt(sweep, 0), ...ends];
  return indices.map((index) => {
    const angle = angleOf(sweep, index);
    const lines: [string, string] = [toAngle(toShown(angle), unit), `[${index}]`];
    const direction = toDirection(angle, forward);
    const halfWidth = measure(lines) / 2;
    const halfHeight = 15;
    const gap = RIM_MARKS + LABEL_GAP + Math.abs(direction.x) * halfWidth + Math.abs(direction.y) * halfHeight;
    return { index, angle, isFixed: fixed.includes(index), lines, direction, gap, halfWidth, halfHeight };
  });
}

/** The height of a picture of a sweep that fills its width, before anything is measured: see `heightOf`. */
export function sweepHeight(
  sweep: Sweep,
  angles: number[],
  count: number | null,
  forward: number,
): ReturnType<typeof heightOf> {
  const widest = ([angle, index]: [string, string]) => LETTER * Math.max(angle.length, index.length);
  const labels = rayLabels(sweep, rayIndices(sweep, angles, count), forward, widest);
  return heightOf([...sweepRim(sweep, forward), ...labels]);
}

/**
 * Drops labels until none overlaps another: first labels that overlap those of forward or an end, then every second
 * one, counted from forward, or every third, and so on; on both sides alike.
 */
export function thinLabels(projection: Projection, labels: RayLabel[]): RayLabel[] {
  const boxes = new Map(labels.map((label) => [label, rimBox(projection, label)]));
  const clash = (a: RayLabel, b: RayLabel) => overlaps(boxes.get(a) as Box, boxes.get(b) as Box, 2);
  const turned = (label: RayLabel) => Math.abs(Math.sin(label.angle / 2));
  const fixed: RayLabel[] = [];
  for (const label of labels.filter(({ isFixed }) => isFixed).sort((a, b) => turned(a) - turned(b))) {
    if (!fixed.some((other) => clash(label, other))) fixed.push(label);
  }
  const pairs = pairsOf(labels.filter(({ isFixed }) => !isFixed));
  // Forward has no pair: the first one is a step away.
  const first = fixed[0] && turned(fixed[0]) < turned(pairs[0]?.[0] ?? fixed[0]) ? 1 : 0;
  for (let step = 1; step <= labels.length; step++) {
    const others = pairs
      .filter((_, i) => (i + first) % step === 0)
      .filter((pair) => !pair.some((label) => fixed.some((other) => clash(label, other))))
      .flat();
    const isClear = others.every((label, i) => !others.slice(i + 1).some((other) => clash(label, other)));
    if (isClear) return labels.filter((label) => fixed.includes(label) || others.includes(label));
  }
  return fixed;
}

/** Labels from forward to behind; two that face each other on both sides stand together. */
function pairsOf(labels: RayLabel[]): RayLabel[][] {
  const toSide = ({ angle }: RayLabel) => Math.atan2(Math.sin(angle), Math.cos(angle));
  const sides = labels.map(toSide).sort((a, b) => a - b);
  const gap = Math.min(...sides.slice(1).map((side, i) => side - (sides[i] as number)));
  const pairs: RayLabel[][] = [];
  for (const label of [...labels].sort((a, b) => Math.abs(toSide(a)) - Math.abs(toSide(b)))) {
    const [last] = pairs.at(-1) ?? [];
    // Each stands at a ray, so that two sides differ slightly.
    const isPair =
      last && Math.abs(toSide(label)) - Math.abs(toSide(last)) < gap / 2 && toSide(label) * toSide(last) < 0;
    if (isPair) pairs.at(-1)?.push(label);
    else pairs.push([label]);
  }
  return pairs;
}

export interface ArcLabel {
  distance: number;
  angle: number;
  box: Box;
}

const ARC_LABEL_HEIGHT = 14;
/** Pixels between an arc and its label. */
const BESIDE = 2;
const ROBOT = 10;
const CANDIDATES = 48;
const LEFT_OF_FORWARD = 0.24;

/**
 * Places of the labels of the arcs: just inside each arc, left of forward, or elsewhere along it when a reading is
 * there. If the next arc is as close, a label lies on its arc. A label keeps its place as long as that is free,
 * so that labels of a live picture do not jump. Without a free place it is left out.
 *
 * @param lines angles of the radial lines
 * @param covered parts of the picture that something covers
 * @param edges angles of lines that stand out, which a label leaves for another place
 */
export function arcLabels(
  projection: Projection,
  sweep: Sweep,
  arcs: { distance: number; width: number }[],
  lines: number[],
  occupied: Occupancy,
  covered: Box[],
  previous: ArcLabel[],
  edges: number[] = [],
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
  const toPixels = (distance: number) => (distance / projection.viewRange) * projection.radius;
  for (const { distance, width } of arcs) {
    const pixels = toPixels(distance);
    const away = Math.min(
      ...arcs.filter((arc) => arc.distance !== distance).map((arc) => Math.abs(toPixels(arc.distance) - pixels)),
    );
    const toLabel = (angle: number): ArcLabel | null => {
      const direction = toDirection(angle, projection.forward);
      const half = (Math.abs(direction.x) * width + Math.abs(direction.y) * ARC_LABEL_HEIGHT) / 2;
      // Next to its arc it is twice as close to that as to any other; on it, it touches no other.
      const isBeside = away >= 3 * (half + BESIDE);
      if (!isBeside && away < half + BESIDE) return null;
      const depth = isBeside ? half + BESIDE : 0;
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
    const isOffEdges = (angle: number) =>
      edges.every((edge) => Math.abs(Math.sin((angle - edge) / 2)) * 2 * pixels > width / 2 + 3);
    const free = (label: ArcLabel | null): label is ArcLabel =>
      label !== null &&
      occupied.count(label.box) === 0 &&
      ![robot, ...covered, ...placed.map(({ box }) => box)].some((box) => overlaps(label.box, box));
    const within = angles.filter(inSweep);
    const stay = before && inSweep(before.angle) ? [before.angle] : [];
    const candidates = [...stay, ...within.filter(isClear), ...within];
    const found = [...candidates.filter(isOffEdges), ...candidates].map(toLabel).find(free);
    if (found) placed.push(found);
  }
  return placed;
}
