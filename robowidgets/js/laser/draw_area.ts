import { write } from "../shared/canvas.ts";
import { angleOf, isFullCircle, type Limits, type Sweep } from "../shared/frames/scan.ts";
import { type Projection, rimBox, toPixel } from "../shared/projection.ts";
import type { Theme } from "../shared/theme.ts";
import type { RayLabel } from "./guides.ts";

/** Traces an arc from the first to the last ray, or back. */
function traceArc(
  context: CanvasRenderingContext2D,
  { centerX, centerY, radius, viewRange, forward }: Projection,
  sweep: Sweep,
  range: number,
  back = false,
) {
  const sign = Math.sign(sweep.angleIncrement);
  const turned = isFullCircle(sweep) ? 2 * Math.PI * sign : angleOf(sweep, sweep.count - 1) - angleOf(sweep, 0);
  // Canvas angles are clockwise, because y points down.
  const first = -(angleOf(sweep, 0) + forward);
  const [from, to] = back ? [first - turned, first] : [first, first - turned];
  context.arc(centerX, centerY, (range / viewRange) * radius, from, to, sign > 0 !== back);
}

/** The detection area to scale: from range_min to range_max over the swept angle. */
export function drawArea(
  context: CanvasRenderingContext2D,
  projection: Projection,
  sweep: Sweep & Limits,
  theme: Theme,
): void {
  const { minRange } = sweep;
  const far = farthest(projection, sweep);
  if (sweep.count === 0 || minRange >= far) return;
  if (sweep.count === 1) {
    drawLine(context, projection, angleOf(sweep, 0), minRange, far, theme.line, 3);
    return;
  }
  context.beginPath();
  traceArc(context, projection, sweep, far);
  // The canvas joins the two arcs with an edge, which a full circle must not have.
  if (isFullCircle(sweep)) {
    const { x, y } = toPixel(projection, minRange, angleOf(sweep, 0));
    context.moveTo(x, y);
  }
  traceArc(context, projection, sweep, minRange, true);
  if (!isFullCircle(sweep)) context.closePath();
  context.fillStyle = theme.area;
  context.fill("evenodd");
  context.strokeStyle = theme.line;
  context.lineWidth = 1;
  context.stroke();
}

/** Pixels of the tick at the rim where a radial line has a number. */
const TICK = 9;

/** The range arcs, and fainter the radial lines. */
export function drawGuides(
  context: CanvasRenderingContext2D,
  projection: Projection,
  sweep: Sweep & Limits,
  arcs: { distance: number }[],
  rays: number[],
  theme: Theme,
): void {
  const far = farthest(projection, sweep);
  for (const index of rays) drawLine(context, projection, angleOf(sweep, index), sweep.minRange, far, theme.line, 1);
  context.strokeStyle = theme.guide;
  context.lineWidth = 0.9;
  for (const { distance } of arcs) {
    context.beginPath();
    traceArc(context, projection, sweep, distance);
    context.stroke();
  }
}

/** Metres to the rim of the area in the picture. */
function farthest({ viewRange }: Projection, { maxRange }: Limits): number {
  return Math.min(maxRange, viewRange);
}

export function drawLine(
  context: CanvasRenderingContext2D,
  projection: Projection,
  angle: number,
  from: number,
  to: number,
  color: string,
  width: number,
): void {
  const [a, b] = [toPixel(projection, from, angle), toPixel(projection, to, angle)];
  context.beginPath();
  context.moveTo(a.x, a.y);
  context.lineTo(b.x, b.y);
  context.strokeStyle = color;
  context.lineWidth = width;
  context.stroke();
}

/** The angle over the index, at the outer end of each radial line, and a tick there. */
export function drawRayLabels(
  context: CanvasRenderingContext2D,
  projection: Projection,
  sweep: Limits,
  labels: RayLabel[],
  theme: Theme,
): void {
  const far = farthest(projection, sweep);
  const inside = Math.max(0, far - (TICK / projection.radius) * projection.viewRange);
  for (const label of labels) {
    drawLine(context, projection, label.angle, inside, far, theme.muted, 1);
    const box = rimBox(projection, label);
    const x = box.x + label.halfWidth;
    write(context, label.lines[0], x, box.y + 8, theme.ink, angleFont(theme), "center");
    write(context, label.lines[1], x, box.y + 23, theme.muted, indexFont(theme), "center");
  }
}

export function angleFont(theme: Theme): string {
  return `600 12px ${theme.font}`;
}

export function indexFont(theme: Theme): string {
  return `11px ${theme.mono}`;
}

/** The robot at the scanner's place, its nose in the robot's forward. */
export function drawRobot(context: CanvasRenderingContext2D, projection: Projection, theme: Theme): void {
  context.save();
  context.translate(projection.centerX, projection.centerY);
  context.rotate(Math.PI / 2 - projection.forward);
  context.beginPath();
  context.moveTo(0, -9);
  context.lineTo(6.5, 7);
  context.lineTo(0, 3.5);
  context.lineTo(-6.5, 7);
  context.closePath();
  context.lineJoin = "round";
  context.lineWidth = 3;
  context.strokeStyle = theme.background;
  context.stroke();
  context.fillStyle = theme.ink;
  context.fill();
  context.restore();
}
