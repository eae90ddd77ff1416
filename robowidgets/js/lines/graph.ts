import type { Theme } from "../shared/theme.ts";
import type { Trace } from "./steps.ts";

/** Seconds that a graph shows. */
export const SECONDS = 10;
const MARGIN = 3;
/** The longest time in seconds between two steps that a curve connects. */
const GAP_S = 1;

/** The small graph of a line: numbers as a curve, True and "reached" as a band, and the cursor. */
export function drawGraph(
  canvas: HTMLCanvasElement,
  trace: Trace,
  kind: string,
  [from, to]: [from: number, to: number],
  cursor: number | null,
  { ink, muted, pointer, area }: Pick<Theme, "ink" | "muted" | "pointer" | "area">,
  ratio: number,
): void {
  const { clientWidth: width, clientHeight: height } = canvas;
  const context = canvas.getContext("2d");
  if (!context || !width) return;
  const size = [Math.round(width * ratio), Math.round(height * ratio)] as const;
  if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  const toX = (at: number) => (width * (at - from)) / (to - from || 1);
  // The graph of a long recording has a point for every few pixels.
  const gap = Math.max(GAP_S, (to - from) / 60);
  if (kind === "number") drawCurve(context, trace, toX, height, ink, gap);
  else drawBand(context, trace, toX, [width, height], kind === "flag" ? ink : muted, area, gap);
  if (cursor === null) return;
  context.fillStyle = pointer;
  context.fillRect(Math.min(width - 1.5, Math.max(0, toX(cursor) - 0.75)), 0, 1.5, height);
}

function drawCurve(
  context: CanvasRenderingContext2D,
  trace: Trace,
  toX: (at: number) => number,
  height: number,
  ink: string,
  gap: number,
): void {
  const levels = trace.flatMap(([, level]) => (level === null ? [] : [level]));
  const [low, high] = [Math.min(...levels), Math.max(...levels)];
  const toY = (level: number) =>
    high > low ? height - MARGIN - ((height - 2 * MARGIN) * (level - low)) / (high - low) : height / 2;
  context.strokeStyle = ink;
  context.lineWidth = 1.25;
  context.lineJoin = "round";
  context.beginPath();
  let before: number | null = null;
  for (const [at, level] of trace) {
    if (level !== null) {
      if (before === null || at - before > gap) context.moveTo(toX(at) - 0.5, toY(level));
      context.lineTo(toX(at), toY(level));
    }
    before = level === null ? null : at;
  }
  context.stroke();
}

function drawBand(
  context: CanvasRenderingContext2D,
  trace: Trace,
  toX: (at: number) => number,
  [width, height]: [number, number],
  ink: string,
  area: string,
  gap: number,
): void {
  const top = Math.round(height / 2) - 4;
  context.fillStyle = area;
  context.fillRect(0, top, width, 8);
  context.fillStyle = ink;
  for (const [from, to] of stretchesOf(trace, gap)) {
    const left = Math.max(0, toX(from));
    context.fillRect(left, top, Math.max(1, toX(to) - left), 8);
  }
}

/** Returns the spans in which a line was true or reached. Drawn step by step, bars would have gaps between them. */
export function stretchesOf(trace: Trace, gap = GAP_S): [from: number, to: number][] {
  const stretches: [number, number][] = [];
  for (const [i, [at, level]] of trace.entries()) {
    if (!level) continue;
    const to = Math.min(trace[i + 1]?.[0] ?? at + 0.1, at + gap);
    const last = stretches.at(-1);
    if (last && last[1] === at) last[1] = to;
    else stretches.push([at, to]);
  }
  return stretches;
}
