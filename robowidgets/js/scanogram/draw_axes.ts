import { write } from "../shared/canvas.ts";
import { toDegrees } from "../shared/format.ts";
import { type Theme, textFont } from "../shared/theme.ts";
import { type TimeAxis, toX } from "../shared/time_axis.ts";
import { timeTicks, toMoment } from "../shared/time_span.ts";
import type { Layout } from "./layout.ts";
import { angleTicks, type Rows } from "./rows.ts";

const APART = 34;
const APART_ALONE = 22;
const WORDS_APART = 92;
const LABEL_HEIGHT = 17;

/**
 * Draws the time axis. A label in ink at the line has the time and the state, and replaces the numbers that it covers.
 */
export function drawTimes(
  context: CanvasRenderingContext2D,
  axis: TimeAxis,
  layout: Layout,
  whole: number,
  line: number,
  theme: Theme,
  state = "",
): void {
  const { right, bottom } = layout;
  const moment = [toMoment(line, whole), state].filter(Boolean).join(" \u00b7 ");
  const taken = drawMoment(context, axis, layout, moment, line, theme);
  context.font = textFont(theme);
  context.textAlign = "center";
  context.textBaseline = "top";
  for (const { time, text } of timeTicks(axis.span, Math.max(2, Math.floor(axis.width / WORDS_APART)), whole)) {
    const x = Math.round(toX(axis, time)) + 0.5;
    context.fillStyle = theme.line;
    context.fillRect(x - 0.5, bottom, 1, 4);
    const half = context.measureText(text).width / 2;
    const middle = Math.min(x, right - half);
    if (taken && middle + half > taken[0] - 4 && middle - half < taken[1] + 4) continue;
    context.fillStyle = theme.muted;
    context.fillText(text, middle, bottom + 8);
  }
}

/** Draws the time of the line, in ink; returns its left and right end. */
function drawMoment(
  context: CanvasRenderingContext2D,
  axis: TimeAxis,
  { left, width, right, bottom }: Layout,
  text: string,
  time: number,
  theme: Theme,
): [number, number] | null {
  const x = toX(axis, time);
  if (x < left - 1 || x > left + width + 1) return null;
  context.font = `650 ${textFont(theme)}`;
  const half = context.measureText(text).width / 2 + 6;
  const middle = Math.min(right - half, Math.max(half + 2, x));
  context.fillStyle = theme.ink;
  context.beginPath();
  context.roundRect(middle - half, bottom + 4, 2 * half, LABEL_HEIGHT, 4);
  context.fill();
  write(context, text, middle, bottom + 4 + LABEL_HEIGHT / 2 + 0.5, theme.background, context.font, "center");
  return [middle - half, middle + half];
}

/**
 * Rows with round angles, the height of each in the picture, and the middle of its label; null if the label at an end
 * of the axis, which is moved into the picture, covers it.
 */
export function angleLabels(
  rows: Rows,
  { top, height }: Layout["scans"],
  hasIndices: boolean,
): { row: number; y: number; middle: number | null }[] {
  const [first, last] = [top + 6, top + height - (hasIndices ? 18 : 5)];
  const labels = angleTicks(rows, height, hasIndices ? APART : APART_ALONE).map((row) => {
    const y = top + (1 - (row + 0.5) / rows.rayOf.length) * height;
    return { row, y, middle: Math.min(last, Math.max(first, hasIndices ? y - 6 : y)) };
  });
  const ends = [labels[0], labels.at(-1)];
  const isClose = (a: number, b: number) => Math.abs(a - b) < (hasIndices ? 25 : 13);
  return labels.map((label) =>
    ends.includes(label) || !ends.some((end) => end && isClose(end.middle, label.middle))
      ? label
      : { ...label, middle: null },
  );
}

/** Angles with their indices at the left, and a fine line through the picture at each. */
export function drawAngles(
  context: CanvasRenderingContext2D,
  rows: Rows,
  { left, width, scans, indices }: Layout,
  theme: Theme,
): void {
  const hasIndices = indices && !rows.byAngle;
  for (const { row, y, middle } of angleLabels(rows, scans, hasIndices)) {
    context.fillStyle = theme.dark ? "#ffffff40" : "#ffffff73";
    context.fillRect(left, Math.round(y), width, 1);
    context.fillStyle = theme.line;
    context.fillRect(left - 4, Math.round(y), 4, 1);
    if (middle === null) continue;
    const degrees = toDegrees(rows.angles[row] as number);
    write(context, degrees, left - 8, middle, theme.ink, `600 ${textFont(theme)}`, "right");
    if (hasIndices) {
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
