import { write } from "../shared/canvas.ts";
import { toDegrees } from "../shared/format.ts";
import type { Theme } from "../shared/theme.ts";
import { type TimeAxis, timeTicks, toX } from "./axis.ts";
import type { Layout } from "./layout.ts";
import { angleTicks, type Rows } from "./rows.ts";

const APART = 34;
const WORDS_APART = 92;

export function textFont(theme: Theme, size = 11): string {
  return `${size}px ${theme.font}`;
}

/** Time below, with a fine line through all bands at each number. */
export function drawTimes(context: CanvasRenderingContext2D, axis: TimeAxis, layout: Layout, theme: Theme): void {
  context.font = textFont(theme);
  context.textAlign = "center";
  context.textBaseline = "top";
  const edge = layout.left + layout.width + 14;
  for (const { time, text } of timeTicks(axis.span, Math.max(2, Math.floor(axis.width / WORDS_APART)))) {
    const x = Math.round(toX(axis, time)) + 0.5;
    context.fillStyle = theme.line;
    context.fillRect(x - 0.5, layout.bottom, 1, 4);
    const half = context.measureText(text).width / 2;
    if (x + half > edge) continue;
    context.fillStyle = theme.muted;
    context.fillText(text, x, layout.bottom + 8);
  }
}

/** Angles with their indices at the left, and a fine line through the picture at each. */
export function drawAngles(
  context: CanvasRenderingContext2D,
  rows: Rows,
  { left, width, scans }: Layout,
  theme: Theme,
): void {
  const count = rows.rayOf.length;
  const [first, last] = [scans.top + 6, scans.top + scans.height - 18];
  for (const row of angleTicks(rows, scans.height, APART)) {
    const y = scans.top + (1 - (row + 0.5) / count) * scans.height;
    context.fillStyle = theme.dark ? "#ffffff40" : "#ffffff73";
    context.fillRect(left, Math.round(y), width, 1);
    context.fillStyle = theme.line;
    context.fillRect(left - 4, Math.round(y), 4, 1);
    const middle = Math.min(last, Math.max(first, y - 6));
    const degrees = toDegrees(rows.angles[row] as number);
    write(context, degrees, left - 8, middle, theme.ink, `600 ${textFont(theme)}`, "right");
    if (!rows.byAngle) {
      write(context, `[${rows.rayOf[row]}]`, left - 8, middle + 12, theme.muted, `10px ${theme.mono}`, "right");
    }
  }
}

/** A filled triangle that points up or down. */
export function drawTriangle(
  context: CanvasRenderingContext2D,
  x: number,
  tip: number,
  base: number,
  half: number,
): void {
  context.beginPath();
  context.moveTo(x, tip);
  context.lineTo(x - half, base);
  context.lineTo(x + half, base);
  context.fill();
}

/** A thin frame round the scans. */
export function drawFrame(context: CanvasRenderingContext2D, { left, width, scans }: Layout, theme: Theme): void {
  context.strokeStyle = theme.line;
  context.lineWidth = 1;
  context.strokeRect(left - 0.5, scans.top - 0.5, width + 1, scans.height + 1);
}
