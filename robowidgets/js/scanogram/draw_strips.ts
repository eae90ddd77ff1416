import { write } from "../shared/canvas.ts";
import { firstWhere } from "../shared/search.ts";
import { type Theme, textFont } from "../shared/theme.ts";
import { type TimeAxis, toX } from "../shared/time_axis.ts";
import type { NamedSpan, Speeds, Whole } from "./data.ts";
import { drawTriangle } from "./draw_axes.ts";
import type { Band } from "./layout.ts";

const ROUNDING = 1e-6;
const LETTERS: Record<string, string> = {
  "linear.x": "x",
  "linear.y": "y",
  "linear.z": "z",
  "angular.x": "roll",
  "angular.y": "pitch",
  "angular.z": "yaw",
};

type Speed = NonNullable<Whole["speed"]>;

/** Returns true if a speed exceeds its limits by more than rounding errors, as in Python. */
function isPast(value: number, limits: [number, number] | null): boolean {
  if (!limits) return false;
  const [low, high] = limits;
  return value < low - ROUNDING * Math.max(1, -low) || value > high + ROUNDING * Math.max(1, high);
}

/** The speed at the ends of a strip: the greatest speed, or the limit if that is not much greater. */
function reachOf(speed: Speed, axis: number): number {
  const { least, greatest } = speed.speeds;
  let most = 0;
  for (const values of [least[axis], greatest[axis]]) {
    for (const value of values ?? []) if (Math.abs(value) > most) most = Math.abs(value);
  }
  const limit = Math.max(...(speed.limits[axis] ?? [0]).map(Math.abs));
  return (most > limit / 2 ? Math.max(most, limit) : most) || 1;
}

/** Draws one axis of the speed: a line from the least to the greatest at each place; red and marked if past a limit. */
export function drawSpeed(
  context: CanvasRenderingContext2D,
  axis: TimeAxis,
  band: Band,
  speed: Speed,
  speeds: Speeds,
  number: number,
  theme: Theme,
): void {
  const limits = speed.limits[number] ?? null;
  const reach = reachOf(speed, number);
  const half = band.height / 2;
  const toY = (value: number) => band.top + half - (value / reach) * (half - 1);
  const { left, width } = axis;
  drawLabel(context, band, left, LETTERS[speed.axes[number] ?? ""] ?? "", theme);
  context.fillStyle = theme.line;
  context.fillRect(left, Math.round(toY(0)), width, 1);
  context.strokeStyle = theme.muted;
  context.setLineDash([3, 3]);
  for (const limit of (limits ?? []).filter((value) => Math.abs(value) <= reach)) {
    const y = Math.round(toY(limit)) + 0.5;
    context.beginPath();
    context.moveTo(left, y);
    context.lineTo(left + width, y);
    context.stroke();
  }
  context.setLineDash([]);
  context.save();
  context.beginPath();
  context.rect(left, band.top - 7, width, band.height + 14);
  context.clip();
  const [least, greatest] = [speeds.least[number], speeds.greatest[number]];
  if (least && greatest) drawLine(context, axis, speed.gap, speeds.startsAt, least, greatest, limits, toY, theme);
  context.restore();
}

function drawLine(
  context: CanvasRenderingContext2D,
  axis: TimeAxis,
  gap: number,
  startsAt: Float64Array,
  least: Float32Array,
  greatest: Float32Array,
  limits: [number, number] | null,
  toY: (value: number) => number,
  theme: Theme,
): void {
  const first = Math.max(0, firstWhere(startsAt, (start) => start >= axis.span[0]) - 1);
  const stop = Math.min(startsAt.length, firstWhere(startsAt, (start) => start > axis.span[1]) + 1);
  const meanStep = ((startsAt.at(-1) ?? 0) - (startsAt[0] ?? 0)) / Math.max(1, startsAt.length - 1);
  const longest = Math.max(gap, 3 * meanStep);
  const over: { x: number; y: number; up: boolean }[] = [];
  context.beginPath();
  context.fillStyle = theme.pointer;
  let before = NaN;
  const zero = toY(0);
  for (let i = first; i < stop; i++) {
    const [low, high, start] = [least[i] as number, greatest[i] as number, startsAt[i] as number];
    const x = toX(axis, start);
    if (Number.isNaN(low)) {
      before = NaN;
      continue;
    }
    const isNext = start - before < longest;
    if (isNext) context.lineTo(x, toY(low));
    else context.moveTo(x, toY(low));
    context.lineTo(x, toY(high) + (low === high ? 0.01 : 0));
    if (isNext) {
      const [from, away] = [toX(axis, before), Math.abs(high) > Math.abs(low) ? high : low];
      context.globalAlpha = 0.16;
      context.fillRect(from, Math.min(zero, toY(away)), x - from, Math.abs(toY(away) - zero));
      context.globalAlpha = 1;
    }
    before = start;
    if (isPast(high, limits)) over.push({ x, y: toY(high), up: true });
    if (isPast(low, limits)) over.push({ x, y: toY(low), up: false });
  }
  context.strokeStyle = theme.pointer;
  context.lineWidth = 1.25;
  context.lineJoin = "round";
  context.stroke();
  drawOver(context, over, zero, theme);
}

/** Moments past a limit: a red line from zero, and a mark at the first of a row of them. */
function drawOver(
  context: CanvasRenderingContext2D,
  over: { x: number; y: number; up: boolean }[],
  zero: number,
  theme: Theme,
): void {
  context.fillStyle = theme.reading;
  let marked = -Infinity;
  for (const { x, y, up } of over) {
    context.fillRect(x - 0.75, Math.min(y, zero), 1.5, Math.abs(zero - y));
    if (x - marked > 9) {
      const [tip, base] = up ? [y - 6, y - 1] : [y + 6, y + 1];
      drawTriangle(context, x, tip, base, 4);
    }
    marked = x;
  }
}

/** The spans in which something was touched. */
export function drawTouches(
  context: CanvasRenderingContext2D,
  axis: TimeAxis,
  band: Band,
  spans: NamedSpan[],
  theme: Theme,
): void {
  const { left, width } = axis;
  drawLabel(context, band, left, "touch", theme);
  context.fillStyle = theme.line;
  context.fillRect(left, Math.round(band.top + band.height / 2), width, 1);
  drawSpans(context, axis, band, spans, theme.touch);
}

/** Spans of time, never too thin to be seen, each with a line at its start: spans may overlap. */
export function drawSpans(
  context: CanvasRenderingContext2D,
  axis: TimeAxis,
  band: Band,
  spans: NamedSpan[],
  color: string,
  alpha = 1,
): void {
  const { left, width, span } = axis;
  context.fillStyle = color;
  for (const { start, end } of spans) {
    if (end < span[0] || start > span[1]) continue;
    const x = Math.min(Math.max(left, toX(axis, start)), left + width - 2);
    context.globalAlpha = alpha;
    context.fillRect(x, band.top, Math.min(left + width, toX(axis, end)) - x, band.height);
    context.globalAlpha = 1;
    context.fillRect(x, band.top, 2, band.height);
  }
}

export function drawLabel(
  context: CanvasRenderingContext2D,
  band: Band,
  left: number,
  text: string,
  theme: Theme,
): void {
  write(context, text, left - 8, band.top + band.height / 2 + 0.5, theme.muted, textFont(theme), "right");
}
