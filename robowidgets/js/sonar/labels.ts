import { type Box, overlaps } from "../shared/box.ts";
import { fit, type Rim, rimBox, toDirection } from "../shared/projection.ts";
import type { Cone } from "./cones.ts";
import { toFloorPoint, type View } from "./floor.ts";

/** Level of detail of a label: distance, index, name, angle; each level has one item less. */
export type Level = 3 | 2 | 1 | 0;

export const LINE = 14;
/** Pixels between the rim and a label. */
const GAP = 5;
/** Radians by which a label may stand away from its cone. */
const FARTHEST = 0.35;
const STEP = 0.01;
/** The picture of a level is at least as large as this part of the one without texts. */
const LEAST_PART = 0.55;
const UP = Math.PI / 2;

export interface Label {
  /** Index of the cone. */
  index: number;
  /** The direction in which the cone meets the rim, and the direction of the label: radians counter-clockwise from forward. */
  from: number;
  angle: number;
  rim: Rim;
  box: Box;
}

export interface Layout {
  level: Level;
  labels: Label[];
  view: View;
}

/** Half the size of a label. */
export interface Half {
  width: number;
  height: number;
}

/**
 * The circle of the picture and a label for each cone at its rim: at the level with the most details that still leaves
 * room for
 * the picture. No two labels overlap: they move along the rim, and if even numbers alone have no room, some are left
 * out.
 *
 * @param halfOf half the size of the label of a cone at a level
 */
export function layOut(cones: Cone[], box: Box, viewRange: number, halfOf: (cone: Cone, level: Level) => Half): Layout {
  const bare = fit(circleRim(), box).radius;
  let last: Layout | null = null;
  for (const level of [3, 2, 1, 0] as const) {
    const placed = spread(cones, box, viewRange, bare, (cone) => halfOf(cone, level));
    last = { level, ...placed };
    if (placed.view.radius >= LEAST_PART * bare && !placed.overlapping) return last;
  }
  const { labels, ...rest } = last as Layout;
  const order = [...labels].sort((a, b) => priority(cones, a) - priority(cones, b));
  const kept: Label[] = [];
  for (const label of order) if (!kept.some((other) => overlaps(label.box, other.box))) kept.push(label);
  return { ...rest, labels: kept };
}

function priority(cones: Cone[], { index }: Label): number {
  return index - (cones[index]?.isNear ? cones.length : 0);
}

function spread(cones: Cone[], box: Box, viewRange: number, bare: number, halfOf: (cone: Cone) => Half) {
  // Labels move along the rim, whose radius depends on their places: a second round corrects it.
  let radius = LEAST_PART * bare;
  let labels: Label[] = [];
  let view: View = { centerX: 0, centerY: 0, radius, viewRange };
  let overlapping = false;
  for (let round = 0; round < 2; round++) {
    const places = cones.map((cone) => ({ cone, from: rimAngle(cone, viewRange) })).sort((a, b) => a.from - b.from);
    const halves = places.map(({ cone }) => halfOf(cone));
    const angles = pushApart(
      places.map(({ from }) => from),
      halves,
      radius,
    );
    const rims = angles.map((angle, i) => toRim(angle, halves[i] as Half));
    view = { ...fit([...rims, ...circleRim()], box), viewRange };
    radius = view.radius;
    labels = places.map(({ cone, from }, i) => ({
      index: cone.index,
      from,
      angle: angles[i] as number,
      rim: rims[i] as Rim,
      box: rimBox(view, rims[i] as Rim),
    }));
    overlapping = labels.some((a, i) => labels.some((b, j) => j > i && overlaps(a.box, b.box)));
  }
  return { labels, view, overlapping };
}

/** The direction from the robot's middle in which the axis of a cone meets the rim, within half a turn. */
function rimAngle({ mount }: Cone, viewRange: number): number {
  const end = toFloorPoint(mount, viewRange, 0);
  return Math.atan2(end.y, end.x);
}

function toRim(angle: number, { width, height }: Half): Rim {
  const direction = toDirection(angle, UP);
  const gap = GAP + Math.abs(direction.x) * width + Math.abs(direction.y) * height;
  return { direction, gap, halfWidth: width, halfHeight: height };
}

/** Moves angles, in their order round the rim, just enough to separate the labels, and no farther than allowed. */
function pushApart(from: number[], halves: Half[], radius: number): number[] {
  const angles = [...from];
  const count = angles.length;
  const boxAt = (i: number) =>
    rimBox({ centerX: 0, centerY: 0, radius }, toRim(angles[i] as number, halves[i] as Half));
  for (let round = 0; round < 80; round++) {
    let moved = false;
    for (let i = 0; i < count; i++) {
      const next = (i + 1) % count;
      if (next === i || !overlaps(boxAt(i), boxAt(next), 1)) continue;
      moved = true;
      for (const [k, by] of [
        [i, -STEP],
        [next, STEP],
      ] as const) {
        const wanted = (angles[k] as number) + by;
        if (Math.abs(wanted - (from[k] as number)) <= FARTHEST) angles[k] = wanted;
      }
    }
    if (!moved) break;
  }
  return angles;
}

/** The rim without labels. */
function circleRim(): Rim[] {
  return [0, 1, 2, 3].map((quarter) => ({
    direction: toDirection((quarter * Math.PI) / 2, UP),
    gap: 0,
    halfWidth: 1,
    halfHeight: 1,
  }));
}
