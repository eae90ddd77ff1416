import { type Box, isWithin, overlaps, type Point } from "../shared/box.ts";
import { stroke, write } from "../shared/canvas.ts";
import { type AngleUnit, sideOf, toAngle, toFixed, toMetres } from "../shared/format.ts";
import type { PopupWords } from "../shared/popup.ts";
import { type Theme, textFont } from "../shared/theme.ts";
import type { Placement } from "./place.ts";

/** Parts of a pixel in the coordinates that Python sends. */
const FINE = 4;
/** Numbers of a dot: index, column, row, millimetres. */
const EACH = 4;
/** Pixels of the screen from a dot within which it is pointed at. */
const REACH = 9;
const DOT = 3;
/** Pixels of a line of words. */
const LINE = 16;
const LIT = 6;
/** Typical metres in the view of a camera, which set the decimals. */
const REACHES = 10;
/** Greatest difference in seconds between a picture and a scan that is not mentioned. */
const TOGETHER = 0.005;

/** A surface, a line or words in the picture, from the ground up. */
export interface SeenThing {
  kind: "area" | "sector" | "cone" | "arc" | "line" | "points" | "text";
  name: string;
  /** Columns and rows in quarters of a pixel. */
  pieces: number[][];
  words?: string;
  color?: string;
  dashed?: boolean;
}

/** The overlay of a picture, from Python. */
export interface Over {
  /** For each reading in the picture its index, its column and row in quarters of a pixel, and its millimetres. */
  dots?: number[];
  angle_min?: number;
  angle_increment?: number;
  drawn?: SeenThing[];
  /** Why something is not there. */
  missing?: string[];
  /** Seconds by which the scan is younger than the picture. */
  apart?: number;
  /** The model of the laser that shows the scan, too. */
  laser?: string;
}

/** A reading in the picture. */
export interface Dot {
  index: number;
  at: Point;
  /** Metres. */
  distance: number;
  /** Radians. */
  angle: number;
}

/** A place of the picture on the screen. A whole number is the middle of a pixel. */
export function toScreen({ scale, left, top }: Placement, column: number, row: number): Point {
  return { x: left + (column / FINE + 0.5) * scale, y: top + (row / FINE + 0.5) * scale };
}

/** The readings on the screen. */
export function dotsOf({ dots = [], angle_min = 0, angle_increment = 0 }: Over, placement: Placement): Dot[] {
  return Array.from({ length: Math.floor(dots.length / EACH) }, (_, i) => {
    const [index = 0, column = 0, row = 0, millimetres = 0] = dots.slice(EACH * i, EACH * i + EACH);
    const angle = angle_min + index * angle_increment;
    return { index, at: toScreen(placement, column, row), distance: millimetres / 1000, angle };
  });
}

/** The reading nearest to a place of the screen, if one is there. */
export function dotAt(dots: Dot[], { x, y }: Point): Dot | null {
  let [found, least]: [Dot | null, number] = [null, REACH];
  for (const dot of dots) {
    const away = Math.hypot(dot.at.x - x, dot.at.y - y);
    if (away < least) [found, least] = [dot, away];
  }
  return found;
}

/** The texts of the pop-up of a reading, the same as in the laser. */
export function describeDot({ index, distance, angle }: Dot, unit: AngleUnit = "deg"): PopupWords {
  return {
    expression: `ranges[${index}]`,
    distance: toMetres(distance, REACHES),
    angle: toAngle(angle, unit),
    side: sideOf(angle),
    details: "",
  };
}

/** The text of the footer: the difference in time between both, and the reasons why something is missing. */
export function wordsOf({ dots, apart, missing = [] }: Over): string {
  const count = (dots?.length ?? 0) / EACH;
  const what = dots ? `${count} ${count === 1 ? "reading" : "readings"} in the picture` : "";
  const isApart = dots !== undefined && apart !== undefined && Math.abs(apart) >= TOGETHER;
  const when = isApart
    ? `scan ${toFixed(Math.abs(apart), 2)} s ${apart > 0 ? "younger" : "older"} than the picture`
    : "";
  return [what, when, ...missing].filter(Boolean).join(", ");
}

/** Draws all of it, from the ground up. */
export function drawOver(
  context: CanvasRenderingContext2D,
  over: Over,
  dots: Dot[],
  lit: number | null,
  placement: Placement,
  room: Box,
  theme: Theme,
): void {
  const names: Name[] = [];
  for (const thing of over.drawn ?? []) drawThing(context, thing, placement, theme, names);
  for (const { at, index } of dots) {
    const size = index === lit ? LIT : DOT;
    // A dot needs an edge to be seen on a picture of any colour.
    context.fillStyle = theme.background;
    context.fillRect(at.x - size / 2 - 1, at.y - size / 2 - 1, size + 2, size + 2);
    context.fillStyle = theme.reading;
    context.fillRect(at.x - size / 2, at.y - size / 2, size, size);
  }
  drawNames(context, names, room, theme);
  const pointed = dots.find(({ index }) => index === lit);
  if (!pointed) return;
  context.beginPath();
  context.arc(pointed.at.x, pointed.at.y, LIT + 2, 0, 2 * Math.PI);
  stroke(context, theme.background, 4);
  stroke(context, theme.pointer, 2);
}

function drawThing(
  context: CanvasRenderingContext2D,
  thing: SeenThing,
  placement: Placement,
  theme: Theme,
  names: Name[],
): void {
  const color = thing.color ?? theme.own;
  for (const piece of thing.pieces) {
    const points = Array.from({ length: piece.length >> 1 }, (_, i) =>
      toScreen(placement, piece[2 * i] ?? 0, piece[2 * i + 1] ?? 0),
    );
    context.lineJoin = "round";
    switch (thing.kind) {
      case "area":
        trace(context, points, true);
        context.globalAlpha = 0.28;
        context.fillStyle = theme.seen;
        context.fill("evenodd");
        context.globalAlpha = 1;
        haloed(context, theme.guide, 1.25, theme);
        break;
      case "sector":
        trace(context, points, true);
        context.globalAlpha = 0.12;
        context.fillStyle = theme.pointer;
        context.fill();
        context.globalAlpha = 1;
        haloed(context, theme.pointer, 1.5, theme);
        names.push({ points, text: thing.name, color: theme.pointer });
        break;
      case "cone":
        trace(context, points, true);
        context.setLineDash(thing.dashed ? [3, 3] : []);
        haloed(context, theme.guide, 1.25, theme);
        context.setLineDash([]);
        names.push({ points, text: `${thing.name} ${thing.words ?? ""}`.trim(), color: theme.ink });
        break;
      case "arc":
        trace(context, points, false);
        haloed(context, theme.reading, 2.5, theme);
        break;
      case "line":
        trace(context, points, false);
        haloed(context, color, 2, theme);
        names.push({ points, text: thing.name, color });
        break;
      case "points":
        for (const { x, y } of points) {
          context.beginPath();
          context.arc(x, y, 3.5, 0, 2 * Math.PI);
          haloed(context, color, 2, theme);
        }
        names.push({ points, text: thing.name, color });
        break;
      case "text":
        names.push({ points, text: thing.words || thing.name, color });
        break;
    }
  }
}

function trace(context: CanvasRenderingContext2D, points: Point[], isClosed: boolean): void {
  context.beginPath();
  for (const { x, y } of points) context.lineTo(x, y);
  if (isClosed) context.closePath();
}

/** Strokes the path, with an edge that separates it from the picture. */
function haloed(context: CanvasRenderingContext2D, color: string, width: number, theme: Theme): void {
  context.globalAlpha = 0.7;
  stroke(context, theme.background, width + 1.5);
  context.globalAlpha = 1;
  stroke(context, color, width);
}

/** A label at the middle of a thing, cut to the room. */
interface Name {
  points: Point[];
  text: string;
  color: string;
}

/** Writes labels within the picture; a label that would cover another one is left out. */
function drawNames(context: CanvasRenderingContext2D, names: Name[], room: Box, theme: Theme): void {
  const font = `600 ${textFont(theme)}`;
  const taken: Box[] = [];
  for (const { points, text, color } of names) {
    const at = points.length && text ? middleIn(points, room) : null;
    if (!at) continue;
    context.font = font;
    const width = context.measureText(text).width + 4;
    if (width > room.width) continue;
    const x = Math.min(room.x + room.width - width / 2, Math.max(room.x + width / 2, at.x));
    const places = [0, 1, -1].map((row) => ({ x: x - width / 2, y: at.y + (row - 0.5) * LINE, width, height: LINE }));
    const free = places.find((box) => isWithin(box, room) && !taken.some((other) => overlaps(box, other)));
    if (!free) continue;
    taken.push(free);
    write(context, text, x, free.y + LINE / 2, color, font, "center", theme.background);
  }
}

/** The middle of the visible part of something; null if all of it is out of view. */
function middleIn(points: Point[], { x, y, width, height }: Box): Point | null {
  const middle = (all: number[], low: number, high: number) => {
    const [least, most] = [Math.max(low, Math.min(...all)), Math.min(high, Math.max(...all))];
    return least <= most ? (least + most) / 2 : null;
  };
  const [across, down] = [
    middle(
      points.map((p) => p.x),
      x,
      x + width,
    ),
    middle(
      points.map((p) => p.y),
      y,
      y + height,
    ),
  ];
  return across === null || down === null ? null : { x: across, y: down };
}
