import { type Box, overlaps } from "../shared/box.ts";
import { write } from "../shared/canvas.ts";
import { toShortMetres } from "../shared/format.ts";
import {
  angleOf,
  NO_MEASUREMENT,
  NOTHING_IN_RANGE,
  OUTSIDE_LIMITS,
  READING,
  type Scan,
  TOO_CLOSE,
  type Validity,
} from "../shared/frames/scan.ts";
import type { Occupancy } from "../shared/occupancy.ts";
import { type Projection, toDirection } from "../shared/projection.ts";
import { type Theme, textFont } from "../shared/theme.ts";
import type { ArcLabel } from "./guides.ts";

/** Pixels of a dot by the number of rays: a few small ones would be hard to find. */
const DOTS = [
  [16, 6],
  [60, 5],
  [180, 4],
  [Infinity, 3],
] as const;
const LANE = 5;
const INNER_LANE = 17;
const MARK_SPACING = 7;
const BEYOND = 5;

interface ReadingStyle {
  theme: Theme;
  /** The classes whose marks are drawn. */
  marks: ReadonlySet<Validity>;
  /** Colour of a reading by its intensity; null for the one red. */
  colorOf: ((intensity: number) => string) | null;
}

/**
 * Draws every ray of a scan: a square dot for a reading, gray marks for the other classes, thinned so that they do not
 * touch. Readings beyond the view are arrow heads at its edge.
 *
 * @returns how many readings lie beyond the view
 */
export function drawReadings(
  context: CanvasRenderingContext2D,
  projection: Projection,
  scan: Scan,
  { theme, marks, colorOf }: ReadingStyle,
  occupied: Occupancy,
): number {
  const scale = projection.radius / projection.viewRange;
  const rim = Math.min(scan.maxRange, projection.viewRange) * scale;
  const dot = dotSize(scan.count, scan.counts[READING], Math.abs(scan.angleIncrement) * projection.radius);
  const last: ({ x: number; y: number } | undefined)[] = [];
  let beyond = 0;
  let color = theme.reading;
  context.fillStyle = color;
  for (let i = 0; i < scan.count; i++) {
    const range = scan.ranges[i] as number;
    const kind = scan.kinds[i] as Validity;
    const { x: ux, y: uy } = toDirection(angleOf(scan, i), projection.forward);
    const isInView = kind === READING && range <= projection.viewRange;
    const distance = isInView ? range * scale : laneOf(kind, range * scale, rim, projection.radius);
    const x = projection.centerX + ux * distance;
    const y = projection.centerY + uy * distance;
    if (isInView) {
      const next = colorOf ? colorOf(scan.intensities[i] as number) : theme.reading;
      if (next !== color) {
        color = next;
        context.fillStyle = color;
      }
      context.fillRect(x - dot / 2, y - dot / 2, dot, dot);
      occupied.mark(x, y);
      continue;
    }
    if (kind === READING) beyond++;
    else if (!marks.has(kind)) continue;
    const shape = kind === READING ? BEYOND : kind;
    const before = last[shape];
    if (before && Math.hypot(before.x - x, before.y - y) < MARK_SPACING) continue;
    last[shape] = { x, y };
    drawMark(context, shape, x, y, ux, uy, theme);
    occupied.mark(x, y);
    context.fillStyle = color;
  }
  return beyond;
}

/**
 * Pixels of a dot: by the rays, whose number does not change; by the readings if there are very few.
 *
 * @param spacing pixels from one ray to the next at the rim: dots must not run together
 */
export function dotSize(rays: number, readings: number, spacing: number): number {
  const [[few, largest], , , [, smallest]] = DOTS;
  if (readings <= few && rays > few) return largest;
  const wanted = DOTS.find(([most]) => rays <= most)?.[1] as number;
  return Math.max(smallest, Math.min(wanted, Math.floor(spacing / 4)));
}

/** Distance in pixels from the scanner to the mark of a ray that has no reading in view. */
function laneOf(kind: Validity, pixels: number, rim: number, edge: number): number {
  if (kind === TOO_CLOSE) return INNER_LANE;
  if (kind === OUTSIDE_LIMITS && pixels <= edge) return Math.max(INNER_LANE, pixels);
  return rim + LANE;
}

function drawMark(
  context: CanvasRenderingContext2D,
  shape: number,
  x: number,
  y: number,
  ux: number,
  uy: number,
  theme: Theme,
): void {
  context.strokeStyle = theme.muted;
  context.lineWidth = 1.2;
  context.beginPath();
  if (shape === NOTHING_IN_RANGE) {
    context.moveTo(x - ux * 2.5, y - uy * 2.5);
    context.lineTo(x + ux * 2.5, y + uy * 2.5);
  } else if (shape === NO_MEASUREMENT) {
    context.moveTo(x - 2.2, y - 2.2);
    context.lineTo(x + 2.2, y + 2.2);
    context.moveTo(x - 2.2, y + 2.2);
    context.lineTo(x + 2.2, y - 2.2);
  } else if (shape === OUTSIDE_LIMITS) {
    context.arc(x, y, 2.2, 0, 2 * Math.PI);
  } else {
    // An arrow head: towards the scanner for too close, away from it for beyond the view.
    const sign = shape === TOO_CLOSE ? -1 : 1;
    context.moveTo(x + sign * ux * 3, y + sign * uy * 3);
    context.lineTo(x - sign * ux * 2 - uy * 3, y - sign * uy * 2 + ux * 3);
    context.lineTo(x - sign * ux * 2 + uy * 3, y - sign * uy * 2 - ux * 3);
    context.closePath();
    context.fillStyle = shape === TOO_CLOSE ? theme.muted : theme.reading;
    context.fill();
    return;
  }
  context.stroke();
}

/** Writes the number of readings beyond the view into the first corner that is free of labels, if there is one. */
export function drawBeyond(
  context: CanvasRenderingContext2D,
  words: string,
  { box, labels }: { box: Box; labels: Box[] },
  theme: Theme,
): void {
  context.font = textFont(theme);
  const [width, height] = [context.measureText(words).width + 14, 14];
  const [left, right] = [box.x + 10, box.x + box.width - 10 - width];
  const [top, bottom] = [box.y + 8, box.y + box.height - 8 - height];
  const corners = [left, right].flatMap((x) => [bottom, top].map((y) => ({ x, y, width, height })));
  const free = corners.find((corner) => !labels.some((label) => overlaps(corner, label)));
  if (!free) return;
  const { x, y } = free;
  drawMark(context, BEYOND, x + 3, y + height / 2, 0, -1, theme);
  write(context, words, x + 12, y + height / 2 + 0.5, theme.muted, textFont(theme), "left");
}

/** The distance at each arc, with a halo. */
export function drawArcLabels(context: CanvasRenderingContext2D, labels: ArcLabel[], theme: Theme): void {
  for (const { distance, box } of labels) {
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2 + 0.5];
    write(context, toShortMetres(distance), x, y, theme.muted, textFont(theme), "center", theme.area);
  }
}
