import type { Box, Point } from "../shared/box.ts";
import { write } from "../shared/canvas.ts";
import { type Projection, toDirection } from "../shared/projection.ts";
import { type Theme, textFont } from "../shared/theme.ts";
import { isFree, type Stage } from "./layer.ts";
import { LIMITS, type Sector, type State, sweepOf } from "./sector.ts";

/** Pixels round the robot that edges leave free. */
const ROBOT = 15;
export const HANDLE = 6;
const SMALL_HANDLE = 3;
/** Opacities of fills, in the picture and in the index view. */
export const SECTOR_OPACITY = 0.045;
export const PICKED_OPACITY = 0.11;

/** Pixels from the scanner to the rim, where handles stand. */
export function rimOf({ sweep, projection }: Stage): number {
  return (Math.min(sweep.maxRange, projection.viewRange) / projection.viewRange) * projection.radius;
}

/** A point at some pixels from the scanner. */
export function pointAt({ centerX, centerY, forward }: Projection, pixels: number, angle: number): Point {
  const { x, y } = toDirection(angle, forward);
  return { x: centerX + x * pixels, y: centerY + y * pixels };
}

/** Fills the wedge of a sector up to some pixels from the scanner. */
export function fillWedge(
  context: CanvasRenderingContext2D,
  projection: Projection,
  sector: Sector,
  pixels: number,
  color: string,
  opacity: number,
): void {
  context.beginPath();
  if (sweepOf(sector) < 2 * Math.PI) context.moveTo(projection.centerX, projection.centerY);
  traceArc(context, projection, sector, pixels);
  context.closePath();
  context.globalAlpha = opacity;
  context.fillStyle = color;
  context.fill();
  context.globalAlpha = 1;
}

function traceArc(
  context: CanvasRenderingContext2D,
  { centerX, centerY, forward }: Projection,
  sector: Sector,
  pixels: number,
): void {
  // Canvas angles are clockwise, because y points down.
  const from = -(sector.start + forward);
  context.arc(centerX, centerY, pixels, from, from - sweepOf(sector), true);
}

export function strokeArc(
  context: CanvasRenderingContext2D,
  projection: Projection,
  sector: Sector,
  pixels: number,
  color: string,
  width: number,
  dash: number[] = [],
): void {
  context.beginPath();
  traceArc(context, projection, sector, pixels);
  context.strokeStyle = color;
  context.lineWidth = width;
  context.setLineDash(dash);
  context.stroke();
  context.setLineDash([]);
}

/** The edges and the rim of a sector. */
export function drawEdges(
  context: CanvasRenderingContext2D,
  stage: Stage,
  sector: Sector,
  isPicked: boolean,
  theme: Theme,
): void {
  const { projection } = stage;
  const rim = rimOf(stage);
  const color = isPicked ? theme.pointer : theme.muted;
  if (sweepOf(sector) < 2 * Math.PI) {
    context.beginPath();
    for (const angle of [sector.start, sector.end]) {
      const [from, to] = [pointAt(projection, ROBOT, angle), pointAt(projection, rim, angle)];
      context.moveTo(from.x, from.y);
      context.lineTo(to.x, to.y);
    }
    context.strokeStyle = color;
    context.lineWidth = isPicked ? 1.5 : 1.1;
    context.stroke();
  }
  strokeArc(context, projection, sector, rim, color, isPicked ? 3.5 : 2.5);
}

/** The limits of a sector as arcs, dashed; the limit that is reached is lit. */
export function drawLimits(
  context: CanvasRenderingContext2D,
  stage: Stage,
  sector: Sector,
  state: State,
  isPicked: boolean,
  theme: Theme,
): void {
  const { projection } = stage;
  const scale = projection.radius / projection.viewRange;
  for (const [name, met] of LIMITS) {
    const pixels = (sector[name] ?? 0) * scale;
    if (pixels === 0 || pixels > rimOf(stage)) continue;
    const lit = met === "stop" ? theme.reading : theme.ink;
    if (state === met) {
      fillWedge(context, projection, sector, pixels, lit, met === "stop" ? 0.18 : 0.1);
      strokeArc(context, projection, sector, pixels, lit, 2.5);
    } else strokeArc(context, projection, sector, pixels, isPicked ? theme.pointer : theme.muted, 1.25, [5, 3]);
  }
}

/** The handles at the ends of the rim; a chosen one is filled. */
export function drawHandles(
  context: CanvasRenderingContext2D,
  stage: Stage,
  sector: Sector,
  isPicked: boolean,
  chosen: "start" | "end" | null,
  theme: Theme,
): void {
  if (sweepOf(sector) >= 2 * Math.PI) return;
  for (const edge of ["start", "end"] as const) {
    const { x, y } = pointAt(stage.projection, rimOf(stage), sector[edge]);
    context.beginPath();
    context.arc(x, y, isPicked ? HANDLE : SMALL_HANDLE, 0, 2 * Math.PI);
    context.fillStyle = chosen === edge ? theme.pointer : theme.background;
    context.fill();
    context.strokeStyle = isPicked ? theme.pointer : theme.muted;
    context.lineWidth = isPicked ? 2.25 : 1.5;
    context.stroke();
  }
}

const LINE = 15;
const HALO = 4;

/** The font of a line of a label: the name, then its state and distance. */
function fontOf(line: number, theme: Theme): string {
  return line ? textFont(theme) : `650 12px ${theme.font}`;
}

/** The place of a sector's name. */
export interface NamePlace {
  box: Box;
  /** Number of lines, steps from the rim inwards, and part of the sweep. */
  at: [lines: number, inset: number, part: number];
}

/**
 * Writes a name and the lines below it inside the sector at the rim, clear of readings, labels and elements; with fewer
 * lines if there is no room for all.
 *
 * @param before its place in the last picture, which it keeps as long as that is free
 * @returns null without room even for the name
 */
export function drawName(
  context: CanvasRenderingContext2D,
  stage: Stage,
  sector: Sector,
  lines: string[],
  color: string,
  theme: Theme,
  before?: NamePlace,
): NamePlace | null {
  const { projection } = stage;
  const widths = lines.map((line, i) => {
    context.font = fontOf(i, theme);
    return context.measureText(line).width;
  });
  const rim = rimOf(stage);
  const toPlace = (at: NamePlace["at"]): NamePlace | null => {
    const [count, inset, part] = at;
    const [width, height] = [Math.max(...widths.slice(0, count)) + 2 * HALO, count * LINE + 2];
    const angle = sector.start + part * sweepOf(sector);
    const { x: dx, y: dy } = toDirection(angle, projection.forward);
    const pixels = rim - 9 - (Math.abs(dx) * width + Math.abs(dy) * height) / 2 - inset * (LINE + 4);
    const middle = pointAt(projection, pixels, angle);
    const box = { x: middle.x - width / 2, y: middle.y - height / 2, width, height };
    return pixels < ROBOT + height || !isFree(stage, box) ? null : { box, at };
  };
  const stay = before && before.at[0] === lines.length ? [before.at] : [];
  let place: NamePlace | null = null;
  for (const at of [...stay, ...placesOf(lines.length)]) {
    place = toPlace(at);
    if (place) break;
  }
  if (!place) return null;
  const { x: left, y: top, width } = place.box;
  for (const [i, line] of lines.slice(0, place.at[0]).entries()) {
    const [x, y] = [left + width / 2, top + 1 + (i + 0.5) * LINE];
    write(context, line, x, y, i ? theme.muted : color, fontOf(i, theme), "center", theme.area);
  }
  return place;
}

/** The places to try for a name, the best first: all lines at the rim in the middle. */
function placesOf(lines: number): NamePlace["at"][] {
  const counts = Array.from({ length: lines }, (_, i) => lines - i);
  return counts.flatMap((count) =>
    [0, 1, 2, 3, 4].flatMap((inset) =>
      [0.5, 0.35, 0.65, 0.2, 0.8].map((part): NamePlace["at"] => [count, inset, part]),
    ),
  );
}
