import { write } from "../canvas.ts";
import type { Mark } from "../marks.ts";
import { firstWhere } from "../search.ts";
import { forcesColors, type Theme, textFont } from "../theme.ts";
import { type TimeAxis, toX } from "../time_axis.ts";

/** A state that was active: start and end in seconds, and its path, such as "Walker.avoid.turn". */
export type StateSpan = Mark;

/** Height of a row of states, and from one row to the next. */
export const ROW = 15;
export const ROW_STEP = 17;

/** Pixels below which a name that is too long is left out, not cut. */
const WORTH_CUTTING = 32;
const PADDING = 4;
const LIGHT = ["#e6eaee", "#c9d1da", "#adb8c4", "#93a0ae"];
const DARK = ["#242b32", "#3a444e", "#4d5863", "#616d7a"];

export function nameOf(path: string): string {
  return path.slice(path.lastIndexOf(".") + 1);
}

/** "Walker › avoid › turn" */
export function toWords(path: string): string {
  return path.replaceAll(".", " \u203a ");
}

/** The name of the machine whose states a row has; empty if there are several. */
export function machineOf(row: StateSpan[]): string {
  const machines = new Set(row.map(([, , path]) => path.slice(0, path.lastIndexOf("."))));
  return machines.size === 1 ? nameOf([...machines][0] ?? "") : "";
}

/** The state of a row at a time; the last one holds at its end, too. */
export function stateAt(row: StateSpan[], time: number): StateSpan | null {
  const state = row[firstWhere(row, ([start]) => start > time) - 1];
  return state && (time < state[1] || (time === state[1] && state === row.at(-1))) ? state : null;
}

/** The states of all rows at a time, outer ones first. */
export function statesAt(rows: StateSpan[][], time: number): StateSpan[] {
  return rows.map((row) => stateAt(row, time)).filter((state) => state !== null);
}

/** The grays of states, by their path: a state keeps its first gray. */
export type Tones = Map<string, number>;

/** Draws each state in a different gray, by the order of the states of its machine. */
export function drawStates(
  context: CanvasRenderingContext2D,
  axis: TimeAxis,
  top: number,
  row: StateSpan[],
  tones: Tones,
  theme: Theme,
): void {
  const grays = theme.dark ? DARK : LIGHT;
  for (const state of row) {
    const path = state[2];
    const machine = path.slice(0, path.lastIndexOf(".") + 1);
    const number = tones.get(path) ?? [...tones.keys()].filter((other) => other.startsWith(machine)).length;
    tones.set(path, number);
    const tone = forcesColors().matches ? theme.background : (grays[number % grays.length] as string);
    drawState(context, axis, top, state, tone, theme.ink, theme);
  }
}

/** Draws the state at a time, in ink. */
export function drawActive(
  context: CanvasRenderingContext2D,
  axis: TimeAxis,
  top: number,
  row: StateSpan[],
  time: number,
  theme: Theme,
): void {
  const state = stateAt(row, time);
  if (state) drawState(context, axis, top, state, theme.ink, theme.background, theme);
}

function drawState(
  context: CanvasRenderingContext2D,
  axis: TimeAxis,
  top: number,
  [start, end, path]: StateSpan,
  tone: string,
  ink: string,
  theme: Theme,
): void {
  const { span, left, width } = axis;
  if (end < span[0] || start > span[1]) return;
  const from = Math.max(left, toX(axis, start));
  // Less by a gap, which separates two states of the same gray.
  const room = Math.max(1, Math.min(left + width, toX(axis, end)) - from - 1);
  context.fillStyle = tone;
  context.fillRect(from, top, room, ROW);
  if (tone === theme.background) {
    context.strokeStyle = theme.line;
    context.lineWidth = 1;
    context.strokeRect(from + 0.5, top + 0.5, Math.max(0, room - 1), ROW - 1);
  }
  const name = cutName(context, nameOf(path), room - 2 * PADDING, theme);
  if (name) write(context, name, from + room / 2, top + ROW / 2 + 0.5, ink, textFont(theme), "center");
}

/** A name that fits into some pixels, cut by an ellipsis; "" if too little of it would remain. */
export function cutName(context: CanvasRenderingContext2D, name: string, room: number, theme: Theme): string {
  context.font = textFont(theme);
  const fits = (text: string) => context.measureText(text).width <= room;
  if (fits(name)) return name;
  if (room < WORTH_CUTTING) return "";
  let length = name.length;
  while (length && !fits(`${name.slice(0, length)}\u2026`)) length--;
  return length ? `${name.slice(0, length)}\u2026` : "";
}
