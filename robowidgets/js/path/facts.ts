import type { Place } from "../shared/floor.ts";
import { toAge, toDegrees, toFixed, toMany, toMetres } from "../shared/format.ts";
import type { PopupWords } from "../shared/popup.ts";
import { isOverlay, type Shown } from "./draw_layers.ts";
import type { Ground } from "./ground.ts";
import { type Cells, cellValue, distanceTo, ellipseOf, lengthOf, wordOf } from "./layers.ts";
import { isKnown, type TimedPose } from "./path.ts";
import { toPose } from "./text.ts";

/** The age of a layer at the time of a frame, or "" if it is of that moment. */
function ageOf(time: number, now: number): string {
  return Number.isFinite(time) && now - time >= 0.005
    ? `${toAge(1000 * (now - time), now - time < 10 ? 2 : 1)} old`
    : "";
}

/** The text of a layer in the list: its content, distance from the robot, and age. */
export function factOf(shown: Shown, robot: Shown | undefined, ground: Ground, now: number): string {
  const { about, state, before } = shown;
  const age = ageOf(state.time, now);
  const drawn = state.points.length < state.total ? `every ${nth(state.total / state.points.length)} drawn` : "";
  const parts: string[] = [];
  if (about.kind === "scan") parts.push(toMany(state.total, "reading"), drawn, age);
  else if (about.kind === "poses") parts.push(toMany(state.total, "pose"), drawn, age);
  else if (about.kind === "cone") {
    const [sensor, ...arc] = state.points;
    const end = arc[Math.floor(arc.length / 2)];
    if (!sensor || !end) parts.push("unknown");
    else parts.push(isKnown(state) ? toMetres(Math.hypot(end.x - sensor.x, end.y - sensor.y)) : "nothing");
    parts.push(age);
  } else if (about.kind === "path") {
    parts.push(state.total ? `${toMetres(lengthOf(state.points))} long` : "empty");
    if (robot && state.total) parts.push(`${robot.about.name} ${toMetres(distanceTo(state.points, robot.state))} off`);
    parts.push(age);
  } else if (about.kind === "grid") {
    const grid = ground.gridOf(state);
    if (!grid) return ground.hasDropped(state) ? "not kept so long" : "on its way";
    const { columns, rows, step, size } = grid.cells;
    parts.push(`${columns * step} \u00D7 ${rows * step} cells of ${toMetres(size / step)}`);
    if (step > 1) parts.push(`drawn: the greatest of ${step} \u00D7 ${step}`);
    parts.push(age);
  } else if (!isKnown(state)) parts.push("no place known");
  else if (shown.isRobot || about.kind === "goal") parts.push(toPose({ ...state, time: 0 }), age);
  else {
    const way = before.at(-1)?.way ?? 0;
    parts.push(`${toMetres(way)} driven`);
    if (robot)
      parts.push(`${toMetres(Math.hypot(state.x - robot.state.x, state.y - robot.state.y))} off ${robot.about.name}`);
    parts.push(age);
  }
  return [...parts, about.note ?? ""].filter(Boolean).join(", ");
}

function nth(count: number): string {
  const whole = Math.round(count);
  return whole === 2 ? "2nd" : whole === 3 ? "3rd" : `${whole}th`;
}

/** "± 0.46 m": half of the longer axis of the ellipse that holds 95 %. */
export function sureness({ state }: Shown): string {
  const ellipse = ellipseOf(state.scatter);
  return ellipse ? `\u00B1 ${toMetres(ellipse.long)}` : "";
}

/** The texts of the pop-up of a cell: the code for it, its value, its place, its distance from the robot. */
export function describeCell(
  { about }: Shown,
  cells: Cells,
  [row, column]: [number, number],
  at: Place,
  robot: Shown | undefined,
): PopupWords {
  const most = about.most ?? 100;
  const value = cellValue(cells, row, column, most);
  const { step } = cells;
  const index = (i: number) => (step === 1 ? String(i) : `${i * step}:${(i + 1) * step}`);
  return {
    expression: `grid[${index(row)}, ${index(column)}]`,
    distance: toFixed(value, 0),
    angle: wordOf(value, most),
    details: [`x ${toMetres(at.x)}, y ${toMetres(at.y)}`, robot ? fromRobot(robot.state, at) : "", about.name]
      .filter(Boolean)
      .join("\n"),
    side: step === 1 ? "" : `greatest of ${step} \u00D7 ${step}`,
  };
}

function fromRobot({ x, y, yaw }: TimedPose, at: Place): string {
  const far = `${toMetres(Math.hypot(at.x - x, at.y - y))} from the robot`;
  return Number.isNaN(yaw) ? far : `${far}, at ${toDegrees(Math.atan2(at.y - y, at.x - x) - yaw)}`;
}

/** The grids under a place, the topmost first. */
export function gridsFrom(layers: readonly Shown[]): Shown[] {
  const grids = layers.filter(({ about }) => about.kind === "grid");
  return [...grids.filter((one) => isOverlay(one, grids)).reverse(), ...grids.filter((one) => !isOverlay(one, grids))];
}
