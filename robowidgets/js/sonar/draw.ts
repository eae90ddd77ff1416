import { type Context, circle, fill, line, stroke, write } from "../shared/canvas.ts";
import { drawBody } from "../shared/floor.ts";
import { toDegrees, toShortMetres } from "../shared/format.ts";
import { NOTHING_IN_RANGE, OUTSIDE_LIMITS, READING, TOO_CLOSE } from "../shared/frames/scan.ts";
import { type Theme, textFont } from "../shared/theme.ts";
import { ticks } from "../shared/ticks.ts";
import type { Cone } from "./cones.ts";
import { scaleOf, toFloorPoint, toPixel, type View } from "./floor.ts";
import { type Label, type Layout, type Level, LINE } from "./labels.ts";
import { shorten, toDistance } from "./text.ts";

/** Radius of the robot in pixels: a ring does not contain its size. */
const ROBOT = 8;
const UP = Math.PI / 2;
const DASHES = [3, 3];
/** Room for a number on a range circle, in pixels. */
const SCALE = { width: 38, height: 16 };
/** Opacity of the red in the cone of an alarm. */
const ALARM_ALPHA = 0.22;

export function distanceFont(theme: Theme): string {
  return `600 12px ${theme.font}`;
}

export function nameFont(theme: Theme): string {
  return `11px ${theme.mono}`;
}

/** The lines of a label below the distance. */
export function linesOf({ index, name, mount }: Cone, level: Level): string[] {
  const named = level >= 2 ? `[${index}] ${shorten(name)}` : `[${index}]`;
  return [...(level >= 1 ? [named] : []), ...(level >= 3 ? [toDegrees(mount.yaw)] : [])];
}

/** The cones from the ground up: their reach, the free part of it, and the arcs of things. */
export function drawCones(context: Context, view: View, cones: Cone[], theme: Theme): void {
  context.save();
  circle(context, { x: view.centerX, y: view.centerY }, view.radius);
  context.clip();
  for (const cone of cones) drawReach(context, view, cone, theme);
  for (const cone of cones) drawFree(context, view, cone, theme);
  drawCircles(context, view, theme);
  for (const cone of cones) drawOutline(context, view, cone, theme);
  for (const cone of cones) drawMet(context, view, cone, theme);
  context.restore();
  circle(context, { x: view.centerX, y: view.centerY }, view.radius);
  stroke(context, theme.line, 1);
  drawBody(context, { x: view.centerX, y: view.centerY }, UP, ROBOT, theme.ink, theme);
}

/** Metres at which a cone ends in the picture. */
function reachIn({ viewRange }: View, { sonar: { maxRange } }: Cone): number {
  return Math.min(maxRange, 2 * viewRange);
}

/** Metres without a thing; 0 if unknown. */
function freeOf(view: View, cone: Cone): number {
  if (!cone.hasCome || cone.isSilent) return 0;
  const { kind, range } = cone.sonar;
  if (kind === READING) return Math.min(range, reachIn(view, cone));
  return kind === NOTHING_IN_RANGE ? reachIn(view, cone) : 0;
}

/** A path along the arc at a distance, and back along the one at another. */
function traceWedge(context: Context, view: View, cone: Cone, from: number, to: number): void {
  const { x, y } = toPixel(view, cone.mount);
  const scale = scaleOf(view);
  const [start, end] = anglesOf(cone);
  context.beginPath();
  context.arc(x, y, to * scale, start, end);
  context.arc(x, y, from * scale, end, start, true);
  context.closePath();
}

function traceArc(context: Context, view: View, cone: Cone, distance: number): void {
  const { x, y } = toPixel(view, cone.mount);
  context.beginPath();
  context.arc(x, y, distance * scaleOf(view), ...anglesOf(cone));
}

/** The angles of a cone for a canvas: clockwise from the right. */
function anglesOf({ mount, view }: Cone): [start: number, end: number] {
  const middle = -(mount.yaw + UP);
  return [middle - view / 2, middle + view / 2];
}

function drawReach(context: Context, view: View, cone: Cone, theme: Theme): void {
  traceWedge(context, view, cone, cone.sonar.minRange, reachIn(view, cone));
  fill(context, theme.area);
}

function drawFree(context: Context, view: View, cone: Cone, theme: Theme): void {
  const free = freeOf(view, cone);
  if (free <= cone.sonar.minRange) return;
  traceWedge(context, view, cone, cone.sonar.minRange, free);
  fill(context, theme.seen);
}

/** The radii of the range circles whose numbers have room. */
function roundDistances({ viewRange, radius }: View): number[] {
  return ticks(0, 0.97 * viewRange, Math.min(5, Math.max(1, Math.floor(radius / SCALE.width)))).slice(1);
}

/** Range circles at round distances. */
function drawCircles(context: Context, view: View, theme: Theme): void {
  for (const distance of roundDistances(view)) {
    circle(context, { x: view.centerX, y: view.centerY }, distance * scaleOf(view));
    stroke(context, theme.line, 0.9);
  }
}

/** The edges of a cone up to a thing; dashed to its reach if nothing is in range, or if that is unknown. */
function drawOutline(context: Context, view: View, cone: Cone, theme: Theme): void {
  const { sonar, isSilent, hasCome } = cone;
  const isReading = sonar.kind === READING && hasCome;
  const end = isReading ? Math.min(sonar.range, reachIn(view, cone)) : reachIn(view, cone);
  traceWedge(context, view, cone, Math.min(sonar.minRange, end), end);
  context.setLineDash(isReading && !isSilent ? [] : DASHES);
  context.globalAlpha = isSilent || !hasCome ? 0.6 : 1;
  stroke(context, theme.guide, 1.25);
  context.globalAlpha = 1;
  context.setLineDash([]);
}

/** The arc of a thing: red for a reading, filled for an alarm; dashed in gray without a reading. */
function drawMet(context: Context, view: View, cone: Cone, theme: Theme): void {
  const { sonar, isNear, isSilent, hasCome } = cone;
  const { kind, range, minRange } = sonar;
  if (!hasCome || ![READING, TOO_CLOSE, OUTSIDE_LIMITS].includes(kind)) return;
  const distance = kind === TOO_CLOSE ? minRange : Math.max(0, range);
  if (isNear && !isSilent) {
    const reach = distance || reachIn(view, cone);
    traceWedge(context, view, cone, 0, Math.max(reach, minRange, (ROBOT + 8) / scaleOf(view)));
    context.globalAlpha = ALARM_ALPHA;
    fill(context, theme.reading);
    context.globalAlpha = 1;
  }
  traceArc(context, view, cone, distance);
  const isMeasured = kind !== OUTSIDE_LIMITS && !isSilent;
  context.setLineDash(kind === READING ? [] : DASHES);
  stroke(context, isMeasured ? theme.reading : theme.ghost, isSilent ? 1.5 : isNear ? 4 : 2.5);
  context.setLineDash([]);
}

/** The distances of the range circles, in the widest gap between cones, clear of readings. */
export function drawScale(context: Context, view: View, cones: Cone[], theme: Theme): void {
  const angle = widestGap(cones);
  const isInCone = ({ mount, view: opening }: Cone) => Math.cos(angle - mount.yaw) > Math.cos(opening / 2);
  const ground = cones.some(isInCone) ? theme.area : theme.background;
  const readings = cones.filter(({ sonar }) => sonar.kind === READING).flatMap((cone) => pointsOf(view, cone));
  for (const distance of roundDistances(view)) {
    const { x, y } = toPixel(view, { x: distance * Math.cos(angle), y: distance * Math.sin(angle) });
    const isFree = !readings.some(
      (at) => Math.abs(at.x - x) < SCALE.width / 2 && Math.abs(at.y - y) < SCALE.height / 2,
    );
    if (!isFree || distance * scaleOf(view) < ROBOT + SCALE.height) continue;
    write(context, toShortMetres(distance), x, y, theme.muted, textFont(theme), "center", ground);
  }
}

/** The direction in the middle between the two axes that are farthest apart. */
function widestGap(cones: Cone[]): number {
  const angles = cones.map(({ mount: { yaw } }) => Math.atan2(Math.sin(yaw), Math.cos(yaw))).sort((a, b) => a - b);
  let [found, widest] = [-UP / 2, 0];
  for (const [i, angle] of angles.entries()) {
    const next = angles[i + 1] ?? (angles[0] as number) + 2 * Math.PI;
    if (next - angle > widest + 1e-6) [found, widest] = [(angle + next) / 2, next - angle];
  }
  return found;
}

/** The distance of each cone, its index and its name, at the rim. */
export function drawLabels(context: Context, { level, labels, view }: Layout, cones: Cone[], theme: Theme): void {
  for (const label of labels) {
    const cone = cones[label.index];
    if (cone) drawLabel(context, view, level, label, cone, theme);
  }
}

function drawLabel(context: Context, view: View, level: Level, label: Label, cone: Cone, theme: Theme): void {
  const { box, from, angle } = label;
  if (Math.abs(angle - from) > 0.06) {
    const end = (at: number, beyond: number) => ({
      x: view.centerX - (view.radius + beyond) * Math.sin(at),
      y: view.centerY - (view.radius + beyond) * Math.cos(at),
    });
    context.beginPath();
    line(context, end(from, 0), end(angle, 5));
    stroke(context, theme.guide, 1);
  }
  const isMeasured = cone.hasCome && !cone.isSilent && cone.sonar.kind === READING;
  const color = cone.isNear && !cone.isSilent ? theme.reading : isMeasured ? theme.ink : theme.muted;
  const x = box.x + box.width / 2;
  const lines = linesOf(cone, level);
  const top = box.y + box.height / 2 - (LINE * (lines.length + 1)) / 2;
  write(context, toDistance(cone, view.viewRange, level < 2), x, top + LINE / 2, color, distanceFont(theme), "center");
  for (const [i, text] of lines.entries()) {
    write(context, text, x, top + LINE * (i + 1.5), theme.muted, nameFont(theme), "center");
  }
}

/** The cone that a pop-up names. */
export function drawPointed(context: Context, view: View, cone: Cone, theme: Theme): void {
  const end = endOf(view, cone);
  context.save();
  circle(context, { x: view.centerX, y: view.centerY }, view.radius);
  context.clip();
  traceWedge(context, view, cone, 0, end);
  context.setLineDash(cone.sonar.kind === READING && cone.hasCome ? [] : [4, 4]);
  stroke(context, theme.pointer, 2);
  context.restore();
}

/** Metres along the axis of a cone up to a thing, or to the edge of the view. */
export function endOf(view: View, cone: Cone): number {
  const { kind, range } = cone.sonar;
  const isMeasured = cone.hasCome && (kind === READING || kind === OUTSIDE_LIMITS);
  return Math.min(isMeasured ? Math.max(0, range) : reachIn(view, cone), view.viewRange);
}

/** The places of a cone in the picture that a pop-up should leave free: the thing, and its axis. */
export function pointsOf(view: View, cone: Cone): { x: number; y: number }[] {
  const end = endOf(view, cone);
  const beside = [-4, -3, -2, -1, 0, 1, 2, 3, 4].map((part) => (part / 8) * cone.view);
  return beside.map((angle) => toPixel(view, toFloorPoint(cone.mount, end, angle)));
}
