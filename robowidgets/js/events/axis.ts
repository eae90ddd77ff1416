import { Canvas, type Context, type Surface, write } from "../shared/canvas.ts";
import { make } from "../shared/dom.ts";
import { type Theme, textFont } from "../shared/theme.ts";
import { type Span, type TimeAxis, toX } from "../shared/time_axis.ts";
import { timeTicks } from "../shared/time_span.ts";
import { ERROR, type Row, WARN } from "./rows.ts";
import { type Times, toTimeText } from "./text.ts";

export const AXIS = 40;
const MARGIN = 12;
const BASE = 24;
/** Heights distinguish levels in addition to colours. */
const [LOW, MIDDLE, HIGH] = [6, 12, 18];
const LEAST_WIDTH = 3;
const PER_TICK = 90;
/** Seconds of a live axis whose times need a decimal. */
const FINE = 10;

/** The data of the axis. */
export interface Axis {
  span: Span;
  times: Times;
  /** Seconds of the cursor, and of the pointer; null if there is none. */
  cursor: number | null;
  pointed: number | null;
}

/** The events over time, as strokes above a line with its times. */
export class AxisView {
  readonly root = make("div", "rw-events-axis");
  readonly #canvas = new Canvas(this.root);
  axis: TimeAxis = { span: [0, 1], left: MARGIN, width: 1 };

  draw(rows: Row[], { span, times, cursor, pointed }: Axis, surface: Surface, theme: Theme): void {
    const context = this.#canvas.begin({ ...surface, height: AXIS });
    this.axis = { span, left: MARGIN, width: Math.max(1, surface.width - 2 * MARGIN) };
    context.fillStyle = theme.guide;
    context.fillRect(MARGIN, BASE, this.axis.width, 1);
    this.#drawTimes(context, times, theme);
    if (pointed !== null) this.#drawLine(context, pointed, theme.pointer, theme);
    if (cursor !== null) this.#drawLine(context, cursor, theme.ink, theme);
    // Over the cursor, which is higher: an error there keeps its colour.
    this.#drawRows(context, rows, theme);
  }

  #drawTimes(context: Context, times: Times, theme: Theme): void {
    const { axis } = this;
    const count = Math.max(1, Math.floor(axis.width / PER_TICK));
    for (const { time, text } of timeTicks(axis.span, count, times.span[1] ?? axis.span[1])) {
      const x = toX(axis, time);
      context.fillStyle = theme.guide;
      context.fillRect(Math.round(x), BASE, 1, 4);
      const label = times.span.length ? text : toTimeText(time, times, axis.span[1] - axis.span[0] < FINE ? 1 : 0);
      const align = x < MARGIN + 24 ? "left" : x > MARGIN + axis.width - 24 ? "right" : "center";
      write(
        context,
        label,
        align === "left" ? MARGIN : align === "right" ? MARGIN + axis.width : x,
        BASE + 10,
        theme.muted,
        textFont(theme),
        align,
      );
    }
  }

  /** Each pixel has the highest level in it: an error among thousands of rows stays visible. */
  #drawRows(context: Context, rows: Row[], theme: Theme): void {
    const { axis } = this;
    const most = new Map<number, number>();
    for (const { seconds, until, level } of rows) {
      if (until < axis.span[0] || seconds > axis.span[1]) continue;
      const [from, to] = [seconds, until].map((time) => Math.round(clamp(toX(axis, time), axis))) as [number, number];
      for (const x of [from, to]) most.set(x, Math.max(level, most.get(x) ?? 0));
      // Bursts of equal events.
      context.fillStyle = colorOf(level, theme);
      context.fillRect(from, BASE - 2, to - from, 2);
    }
    for (const [x, level] of [...most].sort(([, a], [, b]) => a - b)) {
      const height = level >= ERROR ? HIGH : level >= WARN ? MIDDLE : LOW;
      const width = level >= WARN ? LEAST_WIDTH : 1;
      context.fillStyle = colorOf(level, theme);
      context.fillRect(x - (width - 1) / 2, BASE - height, width, height);
    }
  }

  #drawLine(context: Context, time: number, color: string, { background }: Theme): void {
    if (time < this.axis.span[0] || time > this.axis.span[1]) return;
    const x = toX(this.axis, time);
    context.fillStyle = background;
    context.fillRect(x - 1.75, 0, 3.5, BASE + 4);
    context.fillStyle = color;
    context.fillRect(x - 0.75, 0, 1.5, BASE + 4);
  }
}

function colorOf(level: number, theme: Theme): string {
  return level >= ERROR ? theme.reading : level >= WARN ? theme.ink : theme.muted;
}

function clamp(x: number, { left, width }: TimeAxis): number {
  return Math.min(left + width, Math.max(left, x));
}
