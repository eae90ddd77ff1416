import type { Box, Point } from "../shared/box.ts";
import { type Context, circle, fill, line, stroke, write } from "../shared/canvas.ts";
import { type Theme, textFont } from "../shared/theme.ts";
import { ticks } from "../shared/ticks.ts";
import type { Span } from "../shared/time_axis.ts";
import type { Rows } from "./frame.ts";
import { type Entry, toScale } from "./groups.ts";

export type Axis = Entry & { unit: string };

/** Two lines over each other: the values of both at each time of either, NaN for a missing value. */
export interface Pairs {
  times: Float64Array;
  xs: Float64Array;
  ys: Float64Array;
}

/** The values of two lines at each time of the first or the second within a span; each holds until its next. */
export function toPairs(one: Rows, other: Rows, [start, end]: Span): Pairs {
  const times: number[] = [];
  const xs: number[] = [];
  const ys: number[] = [];
  let [i, j] = [0, 0];
  let [x, y] = [NaN, NaN];
  while (i < one.times.length || j < other.times.length) {
    const time = Math.min(one.times[i] ?? Infinity, other.times[j] ?? Infinity);
    for (; one.times[i] === time; i++) x = one.values[i] as number;
    for (; other.times[j] === time; j++) y = other.values[j] as number;
    if (time > end) break;
    if (time < start) continue;
    times.push(time);
    xs.push(x);
    ys.push(y);
  }
  return { times: Float64Array.from(times), xs: Float64Array.from(xs), ys: Float64Array.from(ys) };
}

const ROOM = { left: 64, right: 14, top: 28, bottom: 44 };
/** Pixels between two numbers of a scale, at least. */
const APART = 56;
/** Pixels from a point within which it is pointed at. */
const NEAR = 40;

/** Maps values to places in the picture. */
export class Projection {
  readonly box: Box;
  readonly x: Span;
  readonly y: Span;

  /** @param isEqual true if a unit has the same length on both sides */
  constructor({ xs, ys }: Pairs, width: number, height: number, top: number, isEqual: boolean) {
    this.box = {
      x: ROOM.left,
      y: top + ROOM.top,
      width: Math.max(1, width - ROOM.left - ROOM.right),
      height: Math.max(1, height - top - ROOM.top - ROOM.bottom),
    };
    this.x = around(xs);
    this.y = around(ys);
    if (!isEqual) return;
    const scale = Math.max((this.x[1] - this.x[0]) / this.box.width, (this.y[1] - this.y[0]) / this.box.height);
    this.x = widened(this.x, scale * this.box.width);
    this.y = widened(this.y, scale * this.box.height);
  }

  place(x: number, y: number): Point {
    const { box } = this;
    return {
      x: box.x + ((x - this.x[0]) / (this.x[1] - this.x[0])) * box.width,
      y: box.y + box.height - ((y - this.y[0]) / (this.y[1] - this.y[0])) * box.height,
    };
  }
}

/** The time of the pair nearest to a point of the picture; null if all are far. */
export function timeNear({ times, xs, ys }: Pairs, projection: Projection, point: Point): number | null {
  let [nearest, least] = [-1, NEAR];
  for (let i = 0; i < times.length; i++) {
    const { x, y } = projection.place(xs[i] as number, ys[i] as number);
    const away = Math.hypot(x - point.x, y - point.y);
    if (away < least) [nearest, least] = [i, away];
  }
  return nearest < 0 ? null : (times[nearest] as number);
}

/** Draws two lines over each other, with their scales. */
export function drawPairs(
  context: Context,
  pairs: Pairs,
  projection: Projection,
  axes: [Axis, Axis],
  theme: Theme,
): void {
  const { box } = projection;
  const font = textFont(theme);
  const [bottom, right] = [box.y + box.height, box.x + box.width];
  const [xs, ys] = [ticks(...projection.x, box.width / APART), ticks(...projection.y, box.height / 40)];
  const stepOf = ([first = 0, second = first + 1]: number[]) => second - first;
  for (const value of xs) {
    const { x } = projection.place(value, 0);
    context.beginPath();
    line(context, { x, y: box.y }, { x, y: bottom });
    stroke(context, theme.line, 1);
    write(context, toScale(value, stepOf(xs)), x, bottom + 12, theme.muted, font, "center");
  }
  for (const value of ys) {
    const { y } = projection.place(0, value);
    context.beginPath();
    line(context, { x: box.x, y }, { x: right, y });
    stroke(context, theme.line, 1);
    write(context, toScale(value, stepOf(ys)), box.x - 8, y, theme.muted, font, "right");
  }
  const [across, up] = axes.map(({ label, unit }) => (unit ? `${label} (${unit})` : label)) as [string, string];
  write(context, up, box.x, box.y - 14, theme.ink, `600 ${font}`, "left");
  write(context, across, right, bottom + 30, theme.ink, `600 ${font}`, "right");
  context.beginPath();
  let isOpen = false;
  for (let i = 0; i < pairs.times.length; i++) {
    const [x, y] = [pairs.xs[i] as number, pairs.ys[i] as number];
    if (Number.isNaN(x) || Number.isNaN(y)) {
      isOpen = false;
      continue;
    }
    const place = projection.place(x, y);
    if (isOpen) context.lineTo(place.x, place.y);
    else context.moveTo(place.x, place.y);
    isOpen = true;
  }
  context.lineJoin = "round";
  stroke(context, theme.ink, 1.25);
}

/** Draws a ring at the cursor. */
export function drawRing(context: Context, place: Point, theme: Theme): void {
  circle(context, place, 4.5);
  fill(context, theme.background);
  stroke(context, theme.pointer, 2);
}

/** The span of all finite values, with some room. */
function around(values: Float64Array): Span {
  let [least, most] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < least) least = value;
    if (value > most) most = value;
  }
  if (least > most) return [0, 1];
  const room = most > least ? (most - least) * 0.05 : Math.abs(most) * 0.05 || 0.5;
  return [least - room, most + room];
}

function widened([from, to]: Span, length: number): Span {
  const more = (length - (to - from)) / 2;
  return [from - more, to + more];
}
