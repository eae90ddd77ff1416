import type { Box, Point } from "../shared/box.ts";
import { angleOf, type Limits, type Sweep } from "../shared/frames/scan.ts";
import { type Projection, toPixel } from "../shared/projection.ts";
import { ticks } from "../shared/ticks.ts";
import type { Place } from "./pick.ts";

/** Pixels from the scanner within which the picture takes no ray, and within the rim. */
const INNER = 24;
const RIM = 2;

/** Pixels between two indices on the axis; fewer in a narrow strip. */
const APART = { wide: 76, narrow: 96 };
/** Pixels that the text of an index needs to its neighbour. */
const CLEAR = 44;
/** Pixels between two texts, one above the other. */
const ROW = 16;
/** A strip narrower than this is lower. Pixels. */
const NARROW = 460;

/** The plot of an index strip: rays in the order of the array from left to right, metres from the bottom up. */
interface StripAxes {
  box: Box;
  count: number;
  viewRange: number;
}

/**
 * The plot within a strip of some size: room at the left for metres, below for indices, above for rays without metres.
 */
export function plotBox(width: number, height: number): Box {
  const isNarrow = width < NARROW;
  const [left, right, top, bottom] = isNarrow ? [42, 16, 20, 32] : [46, 22, 24, 36];
  return { x: left, y: top, width: Math.max(1, width - left - right), height: Math.max(1, height - top - bottom) };
}

/** The middle of a ray in pixels; a half index is the edge between two. */
export function toX({ box, count }: StripAxes, index: number): number {
  return box.x + ((index + 0.5) / Math.max(1, count)) * box.width;
}

export function toY({ box, viewRange }: StripAxes, metres: number): number {
  return box.y + box.height * (1 - metres / viewRange);
}

/** The ray at a place, and the metres there, within the plot. */
export function fromStrip(
  { box, count, viewRange }: StripAxes,
  x: number,
  y: number,
): { index: number; metres: number } {
  const part = (x - box.x) / box.width;
  const index = Math.min(count - 1, Math.max(0, Math.floor(part * count)));
  const metres = viewRange * (1 - (y - box.y) / box.height);
  return { index, metres: Math.min(viewRange, Math.max(0, metres)) };
}

/** The ray under a point of the strip, and the place of its distance there in the picture. */
export function toPicture(axes: StripAxes, sweep: Sweep & Limits, projection: Projection, { x, y }: Point): Place {
  const { index, metres } = fromStrip(axes, x, y);
  const perPixel = projection.viewRange / projection.radius;
  const rim = Math.min(sweep.maxRange, projection.viewRange);
  const [least, most] = [INNER * perPixel, rim - RIM * perPixel];
  const place = toPixel(projection, Math.min(most, Math.max(least, metres)), angleOf(sweep, index));
  return index < 0 ? place : { ...place, index };
}

/** Indices with round numbers, from [0] to the last, none too close to another. */
export function indexTicks({ box, count }: StripAxes): number[] {
  if (count < 1) return [];
  const isNarrow = box.width < NARROW;
  const most = Math.max(1, Math.floor(box.width / (isNarrow ? APART.narrow : APART.wide)));
  const last = count - 1;
  const perPixel = count / box.width;
  const round = ticks(0, last, most).filter((index) => Number.isInteger(index) && last - index >= CLEAR * perPixel);
  return [...new Set([0, ...round, last])].filter((index) => index === 0 || index >= CLEAR * perPixel);
}

/** Round metres, without 0, so many that their texts keep apart, and at least one. */
export function metreTicks({ box, viewRange }: StripAxes): number[] {
  const choices = [4, 3, 2, 1].map((count) => ticks(0, viewRange, count).filter((metres) => metres > 0));
  const isFree = ([first = 0, second = Infinity]: number[]) => ((second - first) / viewRange) * box.height >= ROW;
  const found = choices.filter(({ length }) => length > 0);
  return found.find(isFree) ?? found.at(-1) ?? [];
}

const PLACES = ["front", "left front", "left", "left rear", "rear", "right rear", "right", "right front"];

/** The direction of an angle in words: "right rear" for -135 degrees. */
export function placeOf(angle: number): string {
  const eighth = Math.round(angle / (Math.PI / 4));
  return PLACES[((eighth % 8) + 8) % 8] as string;
}
