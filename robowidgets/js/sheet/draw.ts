import type { Box } from "../shared/box.ts";
import { type Context, circle, fill, line, stroke } from "../shared/canvas.ts";
import { toFixed } from "../shared/format.ts";
import { type Theme, textFont } from "../shared/theme.ts";
import { LIT, type Picture } from "./pictures.ts";

const DOT = 2.2;
/** Pixels of the bar behind the dots for which the condition holds. */
const BAR = 6;
const QUARTER = Math.PI / 2;

/** Corners of the arrow head that stands for the robot, in pixels, x to the right. */
const HEAD = [
  [0, -6],
  [4, 5],
  [0, 2.5],
  [-4, 5],
] as const;

/** The drawn metres of a laser: the distance at which it is cut, and the radius of the inner arc. */
export interface Cut {
  reach: number;
  inner: number;
}

/** The picture of a moment in a box. */
export function drawPicture(context: Context, picture: Picture, box: Box, cut: Cut, held: number, theme: Theme): void {
  if (picture.form === "rays") drawRays(context, picture, box, cut, theme);
  else if (picture.form === "line") drawLine(context, picture, box, held, theme);
  else drawWords(context, picture.words, box, theme);
}

function drawRays(context: Context, { values, facts, step }: Picture, box: Box, cut: Cut, theme: Theme): void {
  const [first, between] = facts;
  const radius = Math.min(box.width, box.height) / 2;
  const center = { x: box.x + box.width / 2, y: box.y + box.height / 2 };
  const last = first + (values.length - 1) * between;
  const isWhole = Math.abs(last - first) + Math.abs(between) >= 2 * Math.PI - 1e-3;
  // Angles are counter-clockwise from forward, which is up.
  const sweep = (metres: number) => {
    const pixels = Math.min(radius, (metres / cut.reach) * radius);
    context.beginPath();
    if (isWhole) context.arc(center.x, center.y, pixels, 0, 2 * Math.PI);
    else context.arc(center.x, center.y, pixels, -QUARTER - first, -QUARTER - last, between > 0);
  };
  sweep(cut.reach);
  if (!isWhole) context.lineTo(center.x, center.y);
  fill(context, theme.area);
  sweep(cut.inner);
  stroke(context, theme.line, 1);
  const places: [x: number, y: number, isLit: boolean][] = [];
  for (const [i, value] of (values as Uint16Array).entries()) {
    const away = (value & (LIT - 1)) * step;
    if (!away || away > cut.reach) continue;
    const angle = first + i * between;
    const pixels = (away / cut.reach) * radius;
    places.push([center.x - pixels * Math.sin(angle), center.y - pixels * Math.cos(angle), (value & LIT) !== 0]);
  }
  context.beginPath();
  for (const [x, y, isLit] of places) {
    if (!isLit) continue;
    context.moveTo(x + BAR / 2, y);
    context.arc(x, y, BAR / 2, 0, 2 * Math.PI);
  }
  fill(context, theme.ink);
  context.fillStyle = theme.reading;
  for (const [x, y] of places) context.fillRect(x - DOT / 2, y - DOT / 2, DOT, DOT);
  context.beginPath();
  for (const [x, y] of HEAD) context.lineTo(center.x + x, center.y + y);
  context.closePath();
  fill(context, theme.ink);
}

function drawLine(context: Context, { values, facts }: Picture, box: Box, held: number, theme: Theme): void {
  const numbers = [...values].filter((value) => !Number.isNaN(value));
  const [from, to] = facts;
  const inner = { x: box.x + 8, y: box.y + 16, width: box.width - 16, height: box.height - 34 };
  const toX = (seconds: number) => inner.x + ((seconds - from) / (to - from)) * inner.width;
  context.fillStyle = theme.area;
  context.fillRect(inner.x, inner.y - 4, inner.width, inner.height + 8);
  context.globalAlpha = 0.055;
  context.fillStyle = theme.ink;
  const [left, right] = [toX(0), Math.max(toX(held), toX(0) + 3)];
  context.fillRect(left, inner.y - 4, right - left, inner.height + 8);
  context.globalAlpha = 1;
  context.fillStyle = theme.ink;
  context.fillRect(left, inner.y - 7, right - left, 3);
  if (!numbers.length) return;
  const [least, most] = [Math.min(...numbers), Math.max(...numbers)];
  const room = most - least || 1;
  const toY = (value: number) => inner.y + inner.height * (most === least ? 0.5 : 1 - (value - least) / room);
  if (least < 0 && most > 0) {
    context.beginPath();
    line(context, { x: inner.x, y: toY(0) }, { x: inner.x + inner.width, y: toY(0) });
    stroke(context, theme.guide, 1);
  }
  context.beginPath();
  let isDown = false;
  for (const [i, value] of values.entries()) {
    const x = inner.x + (i / (values.length - 1)) * inner.width;
    if (Number.isNaN(value)) isDown = false;
    else if (isDown) context.lineTo(x, toY(value));
    else {
      context.moveTo(x, toY(value));
      isDown = true;
    }
  }
  stroke(context, theme.ink, 1.75);
  context.font = textFont(theme);
  context.fillStyle = theme.muted;
  context.textBaseline = "middle";
  context.textAlign = "left";
  context.fillText(toFixed(most, 2), inner.x, box.y + 4);
  context.fillText(toFixed(least, 2), inner.x, box.y + box.height - 6);
}

function drawWords(context: Context, words: string, box: Box, theme: Theme): void {
  circle(context, { x: box.x + box.width / 2, y: box.y + box.height / 2 }, Math.min(box.width, box.height) / 2);
  fill(context, theme.area);
  context.font = textFont(theme);
  context.fillStyle = theme.ink;
  context.textAlign = "center";
  context.textBaseline = "middle";
  const lines = toLines(context, words, box.width - 16, 5);
  for (const [i, text] of lines.entries()) {
    context.fillText(text, box.x + box.width / 2, box.y + box.height / 2 + 14 * (i - (lines.length - 1) / 2));
  }
}

/** Words in lines of a width; the last line ends in "…" if they do not fit. */
function toLines(context: Context, words: string, width: number, most: number): string[] {
  const lines: string[] = [];
  let now = "";
  for (const word of words.split(/\s+/)) {
    const next = now ? `${now} ${word}` : word;
    if (now && context.measureText(next).width > width) {
      lines.push(now);
      now = word;
    } else now = next;
  }
  lines.push(now);
  const cut = (text: string) => {
    let short = text;
    while (short.length > 1 && context.measureText(`${short}…`).width > width) short = short.slice(0, -1);
    return `${short}…`;
  };
  const shown = lines.slice(0, most).map((text) => (context.measureText(text).width > width ? cut(text) : text));
  if (lines.length > most) shown[most - 1] = cut(shown[most - 1] ?? "");
  return shown;
}
