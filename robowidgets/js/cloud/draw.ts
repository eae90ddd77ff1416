import type { Box } from "../shared/box.ts";
import { type Context, circle, line, stroke, write } from "../shared/canvas.ts";
import { drawBody } from "../shared/floor.ts";
import { toFixed } from "../shared/format.ts";
import { type Theme, textFont } from "../shared/theme.ts";
import { ticks } from "../shared/ticks.ts";
import type { Cloud } from "./cloud.ts";
import { type Domain, stepsOf } from "./colors.ts";
import { type Axis, along, BELOW, LEFT, type Projection, toMetres, toPixel } from "./projection.ts";
import type { Selection } from "./traits.ts";

/** Pixels between two lines of the grid, about. */
const APART = 64;
/** Radius of the place of the sensor in pixels. */
const SENSOR = 6;
const HALO = 0.14;

/** The ground with a grid of metres, its scales at the left and below, and the place of the sensor. */
export function drawGrid(context: Context, projection: Projection, theme: Theme): void {
  const { box, axes } = projection;
  context.fillStyle = theme.area;
  context.fillRect(box.x, box.y, box.width, box.height);
  const [west, north] = toMetres(projection, { x: box.x, y: box.y });
  const [east, south] = toMetres(projection, { x: box.x + box.width, y: box.y + box.height });
  const step = stepOf(projection);
  const font = textFont(theme);
  context.beginPath();
  const rights = multiples(step, west, east).map((right) => ({ metres: right, at: toPixel(projection, right, 0).x }));
  const ups = multiples(step, south, north).map((up) => ({ metres: up, at: toPixel(projection, 0, up).y }));
  for (const { at } of rights) line(context, { x: crisp(at), y: box.y }, { x: crisp(at), y: box.y + box.height });
  for (const { at } of ups) line(context, { x: box.x, y: crisp(at) }, { x: box.x + box.width, y: crisp(at) });
  stroke(context, theme.line, 1);
  for (const { metres, at } of rights) {
    if (at < box.x + 14 || at > box.x + box.width - 44) continue;
    write(context, numberOf(along(axes.right, metres), step), at, box.y + box.height + 10, theme.muted, font, "center");
  }
  for (const { metres, at } of ups) {
    if (at > box.y + box.height - 6 || at < box.y + 22) continue;
    write(context, numberOf(along(axes.up, metres), step), box.x - 5, at, theme.muted, font, "right");
  }
  write(context, nameOf(axes.right), box.x + box.width, box.y + box.height + 10, theme.muted, font, "right");
  write(context, nameOf(axes.up), box.x - 5, box.y + 8, theme.muted, font, "right");
  drawSensor(context, projection, theme);
}

/** The origin of the frame, usually the place of the sensor: its nose looks along x if x lies in the picture. */
function drawSensor(context: Context, projection: Projection, theme: Theme): void {
  const { axes, box } = projection;
  const at = toPixel(projection, 0, 0);
  const isIn = at.x > box.x && at.x < box.x + box.width && at.y > box.y && at.y < box.y + box.height;
  if (!isIn) return;
  if (axes.near.name === "x") {
    circle(context, at, SENSOR - 1);
    stroke(context, theme.ink, 2);
  } else {
    drawBody(context, at, axes.up.name === "x" ? Math.PI / 2 : 0, SENSOR, theme.ink, theme);
  }
}

function crisp(at: number): number {
  return Math.round(at - 0.5) + 0.5;
}

/** Metres between two lines of the grid. */
function stepOf({ box, scale }: Projection): number {
  const metres = Math.min(box.width, box.height) / scale;
  return ticks(0, metres, Math.max(2, Math.min(box.width, box.height) / APART))[1] ?? 1;
}

function multiples(step: number, from: number, to: number): number[] {
  const [first, last] = [Math.ceil(from / step), Math.floor(to / step)];
  return Array.from({ length: Math.max(0, last - first + 1) }, (_, i) => Number(((first + i) * step).toPrecision(12)));
}

/** A number with the decimals that tell it from the next at a step. */
function numberOf(value: number, step: number): string {
  return toFixed(value, Math.max(0, -Math.floor(Math.log10(step) + 1e-9)));
}

function nameOf({ name }: Axis): string {
  return `${name} m`;
}

/** The ground on which rows of points lie, with rows and columns at its edges. */
export function drawRowsGround(context: Context, box: Box, cloud: Cloud, theme: Theme): void {
  const font = textFont(theme);
  context.fillStyle = theme.area;
  context.fillRect(box.x, box.y, box.width, box.height);
  for (const column of ticks(0, cloud.columns - 1, box.width / 90)) {
    if (!Number.isInteger(column)) continue;
    const x = box.x + ((column + 0.5) / cloud.columns) * box.width;
    if (x > box.x + box.width - 66) continue;
    write(context, String(column), x, box.y + box.height + 10, theme.muted, font, "center");
  }
  for (const row of ticks(0, cloud.rows - 1, Math.max(1, box.height / 40))) {
    if (!Number.isInteger(row)) continue;
    const y = box.y + ((row + 0.5) / cloud.rows) * box.height;
    if (y < box.y + 20) continue;
    write(context, String(row), box.x - 5, y, theme.muted, font, "right");
  }
  write(context, "column", box.x + box.width, box.y + box.height + 10, theme.muted, font, "right");
  write(context, "row", box.x - 5, box.y + 8, theme.muted, font, "right");
}

/** Place and domain of the bar of the legend. */
export interface Legend {
  bar: Box;
  domain: Domain;
}

/** Pixels of the legend at the side of the picture. */
export const LEGEND = 68;
const [BAR, MOST] = [10, 220];

export function legendIn(box: Box, domain: Domain): Legend {
  const height = Math.max(30, Math.min(MOST, box.height - 46));
  return { domain, bar: { x: box.x + box.width + 12, y: box.y + 26, width: BAR, height } };
}

/** The value of a place on the legend, within its domain. */
export function valueAt({ bar, domain: [low, high] }: Legend, y: number): number {
  const share = Math.min(1, Math.max(0, (bar.y + bar.height - y) / bar.height));
  return low + share * (high - low);
}

/** The colour bar with its values, from the lowest at the bottom to the highest. */
export function drawLegend(
  context: Context,
  legend: Legend,
  title: string,
  band: readonly [number, number] | undefined,
  theme: Theme,
): void {
  const { bar, domain } = legend;
  const [low, high] = domain;
  const steps = stepsOf(theme.dark);
  for (let y = 0; y < bar.height; y++) {
    const share = (bar.height - y - 0.5) / bar.height;
    context.fillStyle = steps[Math.min(steps.length - 1, Math.floor(share * steps.length))] ?? "gray";
    context.fillRect(bar.x, bar.y + y, bar.width, 1.5);
  }
  const font = textFont(theme);
  const [name = "", unit = ""] = title.split(/ (?=\S+$)/);
  write(
    context,
    fitted(context, unit ? `${name} ${unit}` : name, LEGEND - 10, font),
    bar.x,
    bar.y - 14,
    theme.ink,
    font,
    "left",
  );
  const apart = ticks(low, high, Math.max(1, bar.height / 34));
  const step = (apart[1] ?? high) - (apart[0] ?? low) || 1;
  const toY = (value: number) => bar.y + bar.height * (1 - (value - low) / (high - low || 1));
  for (const value of low === high ? [low] : apart) {
    context.beginPath();
    line(context, { x: bar.x + bar.width, y: toY(value) }, { x: bar.x + bar.width + 3, y: toY(value) });
    stroke(context, theme.guide, 1);
    write(context, short(value, step), bar.x + bar.width + 6, toY(value), theme.muted, font, "left");
  }
  if (!band) return;
  const [top, bottom] = [toY(Math.min(high, band[1])), toY(Math.max(low, band[0]))];
  context.strokeStyle = theme.pointer;
  context.lineWidth = 2;
  context.strokeRect(bar.x - 3, top, bar.width + 6, Math.max(1, bottom - top));
}

function short(value: number, step: number): string {
  return Math.abs(value) >= 1e5 ? value.toPrecision(2).replace("e+", "e") : numberOf(value, step);
}

/** Returns a text, cut to fit a width. */
function fitted(context: Context, text: string, width: number, font: string): string {
  context.font = font;
  let shown = text;
  while (shown.length > 2 && context.measureText(shown).width > width)
    shown = `${shown.replace(/…$/, "").slice(0, -1)}…`;
  return shown;
}

/**
 * The bounds that the user has drawn, on the axes that the picture shows; an axis without bounds reaches from edge to
 * edge.
 */
export function drawSelection(context: Context, projection: Projection, selection: Selection, theme: Theme): void {
  const { axes, box } = projection;
  const [rights, ups] = [selection[axes.right.name], selection[axes.up.name]];
  if (!rights && !ups) return;
  const at = (axis: Axis, bounds: [number, number] | undefined, isUp: boolean): [number, number] => {
    if (!bounds) return isUp ? [box.y, box.y + box.height] : [box.x, box.x + box.width];
    const ends = bounds.map((bound) => {
      const place = isUp ? toPixel(projection, 0, along(axis, bound)) : toPixel(projection, along(axis, bound), 0);
      return isUp ? place.y : place.x;
    });
    return [Math.min(...ends), Math.max(...ends)];
  };
  const [left, right] = at(axes.right, rights, false);
  const [top, bottom] = at(axes.up, ups, true);
  context.save();
  context.beginPath();
  context.rect(box.x, box.y, box.width, box.height);
  context.clip();
  context.globalAlpha = HALO;
  context.fillStyle = theme.pointer;
  context.fillRect(left, top, right - left, bottom - top);
  context.globalAlpha = 1;
  context.strokeStyle = theme.pointer;
  context.lineWidth = 1.5;
  context.strokeRect(left, top, right - left, bottom - top);
  context.restore();
}

/** The room of the picture within a card, without its scales and its legend. */
export function roomIn(width: number, height: number, top: number, hasLegend: boolean): Box {
  return {
    x: LEFT,
    y: top + 4,
    width: Math.max(20, width - LEFT - (hasLegend ? LEGEND : 10)),
    height: Math.max(20, height - top - 4 - BELOW),
  };
}
