import { type Box, isWithin, overlaps } from "../shared/box.ts";
import { type Context, circle, fill, line, stroke, write } from "../shared/canvas.ts";
import { clipToFloor, drawBody, floorOf, type Place, type Pose, type Projection, toPixel } from "../shared/floor.ts";
import { toShortMetres } from "../shared/format.ts";
import { Occupancy } from "../shared/occupancy.ts";
import { drawShape } from "../shared/shapes/draw.ts";
import { type Theme, textFont } from "../shared/theme.ts";
import type { Shape } from "../shared/traits.ts";
import type { Ground } from "./ground.ts";
import { ellipseOf, type LayerAbout, type LayerState } from "./layers.ts";
import { isKnown, multiples, type Point, type TimedPose } from "./path.ts";
import type { PlacedShape } from "./traits.ts";

const ROBOT = 9;
const DOT = 2.6;
/** Pixels of the needle of one of many poses. */
const NEEDLE = 9;
const HALO = 3.5;
/** Pixels between two lines of the floor, and between two of their numbers, at least. */
const [LINES, NUMBERS] = [24, 60];
/** Pixels between the points of a path that names avoid. */
const STEP = 5;
/** Dashes of other paths than the robot's, by their order. */
const DASHES = [[], [2, 3], [8, 3, 2, 3], [7, 4]];

/** A layer on show, with all data for drawing it. */
export interface Shown {
  about: LayerAbout;
  state: LayerState;
  /** Path of a pose up to now, and after. */
  before: Point[];
  after: Point[];
  isRobot: boolean;
}

export interface Scene {
  layers: Shown[];
  ground: Ground;
  shapes: PlacedShape[];
  now: TimedPose;
  named: Point | null;
}

/** Returns true if a grid lies over the ground: the first grid that is not a costmap is the ground. */
export function isOverlay({ about }: Shown, layers: readonly Shown[]): boolean {
  const first = layers.find((one) => one.about.kind === "grid" && !/costmap/i.test(one.about.name));
  return first !== undefined ? first.about !== about : /costmap/i.test(about.name);
}

/** Draws the map on the floor, from the ground up. */
export function drawMap(context: Context, projection: Projection, scene: Scene, theme: Theme): void {
  const { layers, named } = scene;
  const of = (kind: LayerAbout["kind"]) => layers.filter(({ about }) => about.kind === kind);
  const grids = of("grid");
  clipToFloor(context, projection, () => {
    for (const one of grids)
      if (!isOverlay(one, grids)) drawCells(context, projection, one, scene.ground, false, theme);
    drawLines(context, projection, theme);
    for (const one of grids) if (isOverlay(one, grids)) drawCells(context, projection, one, scene.ground, true, theme);
    const poses = of("pose");
    const others = poses.filter(({ isRobot }) => !isRobot);
    for (const [i, one] of others.entries())
      drawOther(context, projection, one, DASHES[i % DASHES.length] ?? [], theme);
    for (const one of of("path")) drawPlan(context, projection, one, theme);
    for (const one of of("poses")) drawPoses(context, projection, one.state.points, theme);
    for (const one of poses.filter(({ isRobot }) => isRobot)) drawRobot(context, projection, one, theme);
    for (const { state } of of("cone")) drawCone(context, projection, state, theme);
    for (const one of of("scan")) drawScan(context, projection, one.state.points, theme);
    for (const { state } of of("goal")) drawGoal(context, projection, state, theme);
    for (const shape of scene.shapes) drawPlacedShape(context, projection, shape, theme);
    for (const { state } of poses.filter(({ isRobot }) => isRobot)) {
      const at = toPixel(projection, state);
      if (Number.isNaN(state.yaw)) {
        // A position without a heading: GPS.
        circle(context, at, ROBOT / 2);
        fill(context, theme.ink);
      } else drawBody(context, at, state.yaw, ROBOT, theme.ink, theme);
    }
    if (named) {
      circle(context, toPixel(projection, named), 5.5);
      stroke(context, theme.pointer, 2);
    }
  });
  drawNames(context, projection, scene, theme);
  drawScale(context, projection, theme);
}

/** Round metres that take at least so many pixels. */
function stepOf({ scale }: Projection, pixels: number): number {
  const power = 10 ** Math.floor(Math.log10(pixels / scale));
  return ([1, 2, 5].find((step) => step * power * scale >= pixels) ?? 10) * power;
}

/** Lines of the floor, with their metres along the edges. */
function drawLines(context: Context, projection: Projection, theme: Theme): void {
  const { west, east, south, north } = projection.bounds;
  const step = stepOf(projection, LINES);
  context.beginPath();
  for (const x of multiples(step, west, east))
    line(context, toPixel(projection, { x, y: south }), toPixel(projection, { x, y: north }));
  for (const y of multiples(step, south, north))
    line(context, toPixel(projection, { x: west, y }), toPixel(projection, { x: east, y }));
  context.globalAlpha = 0.7;
  stroke(context, theme.line, 1);
  context.globalAlpha = 1;
}

/** Metres along the lower and the left edge of the floor. */
function drawScale(context: Context, projection: Projection, theme: Theme): void {
  const { west, east, south, north } = projection.bounds;
  const { x: left, y: top, width, height } = floorOf(projection);
  const step = stepOf(projection, NUMBERS);
  const font = textFont(theme);
  const text = (value: number) => toShortMetres(Number(value.toPrecision(12))).replace(/ k?m$/, "");
  for (const x of multiples(step, west, east)) {
    const at = toPixel(projection, { x, y: south }).x;
    if (at > left + 34 && at < left + width - 16)
      write(context, text(x), at, top + height - 9, theme.muted, font, "center", theme.area);
  }
  for (const y of multiples(step, south, north)) {
    const at = toPixel(projection, { x: west, y }).y;
    if (at > top + 12 && at < top + height - 24)
      write(context, text(y), left + 6, at, theme.muted, font, "left", theme.area);
  }
}

function drawCells(
  context: Context,
  projection: Projection,
  { about, state }: Shown,
  ground: Ground,
  isOver: boolean,
  theme: Theme,
): void {
  const grid = ground.gridOf(state);
  const picture = grid && ground.pictureOf(about, grid.cells, isOver, theme);
  if (!grid || !picture) return;
  const { cells, corner } = grid;
  const at = toPixel(projection, corner);
  const pixels = cells.size * projection.scale;
  context.save();
  context.translate(at.x, at.y);
  context.rotate(-corner.yaw);
  context.scale(pixels, pixels);
  // Cells of a pixel and more have sharp edges.
  context.imageSmoothingEnabled = pixels < 1;
  context.imageSmoothingQuality = "high";
  context.drawImage(picture, 0, -cells.rows);
  context.restore();
}

/** Adds a path to the context, with a new stroke after each jump. */
function trace(context: Context, projection: Projection, points: readonly (Place & { isAfterJump?: boolean })[]): void {
  context.beginPath();
  context.lineJoin = "round";
  for (const point of points) {
    const { x, y } = toPixel(projection, point);
    if (point.isAfterJump) context.moveTo(x, y);
    else context.lineTo(x, y);
  }
}

/** Another path than the robot's, thin, with a hollow end. */
function drawOther(context: Context, projection: Projection, one: Shown, dash: number[], theme: Theme): void {
  drawEllipse(context, projection, one.state, theme.guide);
  trace(context, projection, one.before);
  context.setLineDash(dash);
  stroke(context, theme.guide, 1.25);
  context.setLineDash([]);
  const at = toPixel(projection, one.state);
  if (!Number.isNaN(one.state.yaw)) {
    context.beginPath();
    line(context, at, ahead(at, one.state.yaw, 12));
    stroke(context, theme.guide, 1.25);
  }
  circle(context, at, 4.5);
  fill(context, theme.background);
  stroke(context, theme.guide, 1.5);
}

/** The path of the robot, with a white edge, the rest of it, its start, and the uncertainty of the pose. */
function drawRobot(context: Context, projection: Projection, { state, before, after }: Shown, theme: Theme): void {
  trace(context, projection, after);
  stroke(context, theme.guide, 1.25);
  trace(context, projection, before);
  stroke(context, theme.background, HALO);
  stroke(context, theme.ink, 1.75);
  const [start] = before;
  if (start) {
    circle(context, toPixel(projection, start), 3.5);
    fill(context, theme.area);
    stroke(context, theme.ink, 1.25);
  }
  drawEllipse(context, projection, state, theme.ink);
}

function drawEllipse(context: Context, projection: Projection, state: LayerState, color: string): void {
  const ellipse = ellipseOf(state.scatter);
  if (!ellipse) return;
  const { x, y } = toPixel(projection, state);
  const { scale } = projection;
  context.beginPath();
  context.ellipse(x, y, ellipse.long * scale, ellipse.short * scale, -ellipse.yaw, 0, 2 * Math.PI);
  context.globalAlpha = 0.07;
  fill(context, color);
  context.globalAlpha = 1;
  context.setLineDash([4, 3]);
  stroke(context, color, 1.25);
  context.setLineDash([]);
}

function drawPlan(context: Context, projection: Projection, { state: { points } }: Shown, theme: Theme): void {
  trace(context, projection, points);
  context.setLineDash([6, 4]);
  stroke(context, theme.ink, 1.5);
  context.setLineDash([]);
}

function drawPoses(context: Context, projection: Projection, poses: readonly Pose[], theme: Theme): void {
  context.beginPath();
  for (const pose of poses) {
    const at = toPixel(projection, pose);
    if (Number.isNaN(pose.yaw)) continue;
    line(context, at, ahead(at, pose.yaw, NEEDLE));
  }
  context.globalAlpha = 0.6;
  stroke(context, theme.muted, 1);
  context.globalAlpha = 1;
  context.fillStyle = theme.muted;
  for (const pose of poses) {
    const { x, y } = toPixel(projection, pose);
    context.fillRect(x - 1, y - 1, 2, 2);
  }
}

function drawScan(context: Context, projection: Projection, places: readonly Place[], theme: Theme): void {
  context.fillStyle = theme.reading;
  for (const place of places) {
    const { x, y } = toPixel(projection, place);
    context.fillRect(x - DOT / 2, y - DOT / 2, DOT, DOT);
  }
}

/** The cone of a sonar: red if it met something, dashed if it met nothing. */
function drawCone(context: Context, projection: Projection, state: LayerState, theme: Theme): void {
  const [sensor, ...arc] = state.points.map((place) => toPixel(projection, place));
  if (!sensor) return;
  const isReading = isKnown(state);
  context.beginPath();
  for (const { x, y } of [sensor, ...arc]) context.lineTo(x, y);
  context.closePath();
  context.setLineDash(isReading ? [] : [3, 3]);
  stroke(context, theme.guide, 1.25);
  context.setLineDash([]);
  if (!isReading) return;
  context.beginPath();
  for (const { x, y } of arc) context.lineTo(x, y);
  stroke(context, theme.reading, 2.5);
}

function drawGoal(context: Context, projection: Projection, goal: Pose, theme: Theme): void {
  const at = toPixel(projection, goal);
  circle(context, at, 8);
  stroke(context, theme.pointer, 2);
  circle(context, at, 2.5);
  fill(context, theme.pointer);
  if (Number.isNaN(goal.yaw)) return;
  context.beginPath();
  line(context, ahead(at, goal.yaw, 8), ahead(at, goal.yaw, 15));
  stroke(context, theme.pointer, 2);
}

function ahead({ x, y }: Place, yaw: number, pixels: number): Place {
  return { x: x + pixels * Math.cos(yaw), y: y - pixels * Math.sin(yaw) };
}

/** A place of a shape in the frame of the map. */
export function placeOf({ from = [0, 0, 0] }: PlacedShape, [x, y]: readonly [number, number]): Place {
  const [left, low, yaw] = from;
  return { x: left + x * Math.cos(yaw) - y * Math.sin(yaw), y: low + x * Math.sin(yaw) + y * Math.cos(yaw) };
}

/** The places of a shape; a shape by rays has no places on a map. */
export function spotsOf(shape: Shape): [number, number][] {
  return shape.at.filter((spot) => typeof spot !== "number");
}

function drawPlacedShape(context: Context, projection: Projection, shape: PlacedShape, theme: Theme): void {
  const places = spotsOf(shape);
  if (places.length) drawShape(context, (place) => toPixel(projection, placeOf(shape, place)), shape, places, theme);
}

/** Names next to their things, with a halo, without overlaps. */
function drawNames(context: Context, projection: Projection, scene: Scene, theme: Theme): void {
  const floor = floorOf(projection);
  const taken: Box[] = [];
  const boxOf = ({ x, y }: Place, r: number) => ({ x: x - r, y: y - r, width: 2 * r, height: 2 * r });
  const labels: { at: Place; text: string; color: string; isBold: boolean }[] = [];
  for (const { about, state, isRobot } of scene.layers) {
    if (["scan", "cone", "grid", "poses"].includes(about.kind)) continue;
    const end = about.kind === "path" ? state.points.at(-1) : state;
    if (!end || !isKnown(end)) continue;
    const at = toPixel(projection, end);
    if (about.kind !== "path") taken.push(boxOf(at, isRobot ? ROBOT : 6));
    const color = about.kind === "goal" ? theme.pointer : isRobot ? theme.ink : theme.muted;
    labels.push({ at, text: about.name, color, isBold: isRobot || about.kind === "goal" });
  }
  for (const shape of scene.shapes) {
    const places = spotsOf(shape).map((spot) => toPixel(projection, placeOf(shape, spot)));
    if (!places.length) continue;
    const middle = {
      x: places.reduce((sum, { x }) => sum + x, 0) / places.length,
      y: places.reduce((sum, { y }) => sum + y, 0) / places.length,
    };
    labels.push({ at: middle, text: shape.text || shape.name, color: shape.color ?? theme.own, isBold: true });
  }
  const ways = markWays(
    floor,
    [
      ...scene.layers.flatMap(({ about, state, before }) =>
        about.kind === "path" ? [state.points] : about.kind === "pose" ? [before] : [],
      ),
      ...scene.shapes.map((shape) => spotsOf(shape).map((spot) => placeOf(shape, spot))),
    ].map((places) => places.map((place) => toPixel(projection, place))),
  );
  for (const { at, text, color, isBold } of labels) {
    const font = isBold ? `600 ${textFont(theme)}` : textFont(theme);
    context.font = font;
    const width = context.measureText(text).width;
    const free = spotsFor(at, width).filter(
      (tried) => isWithin(tried, floor) && !taken.some((one) => overlaps(one, tried, 2)),
    );
    const crossed = free.map((tried) => ways.count(tried));
    const box = free[crossed.indexOf(Math.min(...crossed))];
    if (!box) continue;
    taken.push(box);
    write(context, text, box.x, box.y + 7, color, font, "left", theme.area);
  }
}

/** Marks the parts of the picture that paths cover. */
function markWays({ x, y, width, height }: Box, ways: Place[][]): Occupancy {
  const marked = new Occupancy(x + width, y + height);
  for (const way of ways) {
    for (const [i, to] of way.entries()) {
      const from = way[i - 1] ?? to;
      const count = Math.min(200, Math.max(1, Math.ceil(Math.hypot(to.x - from.x, to.y - from.y) / STEP)));
      for (let k = 1; k <= count; k++)
        marked.mark(from.x + ((to.x - from.x) * k) / count, from.y + ((to.y - from.y) * k) / count);
    }
  }
  return marked;
}

/** Places for a name next to its thing, best first. */
function spotsFor({ x, y }: Place, width: number): Box[] {
  const size = { width, height: 14 };
  return [12, 20, 32].flatMap((gap) => [
    { x: x + gap, y: y - 7, ...size },
    { x: x + gap * 0.7, y: y - 7 - gap, ...size },
    { x: x + gap * 0.7, y: y - 7 + gap, ...size },
    { x: x - gap - width, y: y - 7, ...size },
    { x: x - width / 2, y: y - 7 - gap, ...size },
    { x: x - width / 2, y: y - 7 + gap, ...size },
  ]);
}

/** The measuring line of the user, with its length. */
export function drawMeasure(context: Context, projection: Projection, from: Place, to: Place, theme: Theme): void {
  const [a, b] = [toPixel(projection, from), toPixel(projection, to)];
  context.beginPath();
  line(context, a, b);
  stroke(context, theme.background, 4);
  stroke(context, theme.pointer, 2);
  for (const end of [a, b]) {
    circle(context, end, 3.5);
    fill(context, theme.background);
    stroke(context, theme.pointer, 2);
  }
}
