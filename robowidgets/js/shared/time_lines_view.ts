import { Canvas, type Context, line, type Surface, stroke, watchSize, write } from "./canvas.ts";
import { make, pointIn, set, setHidden } from "./dom.ts";
import { on } from "./events.ts";
import { toFixed } from "./format.ts";
import { type Theme, textFont } from "./theme.ts";
import { type Point, pointAt, type TimeLine, toRuns } from "./time_lines.ts";

const ROW = 44;
const FOOT = 18;
/** Pixels left and right of the lines, for names and numbers. */
const [NAMES, NUMBERS] = [40, 62];

/**
 * The last seconds of some values below a picture: measured and commanded, limits, and the spans past them. It makes
 * its elements with the first values.
 */
export class TimeLinesView {
  readonly #root = make("div", "rw-over-time");
  /** Places the element, and listens to it. */
  readonly #open: () => Canvas;
  #canvas: Canvas | null = null;
  #size: Surface = { width: 0, height: 0, ratio: 1 };
  #pointer: number | null = null;

  constructor(picture: HTMLElement, redraw: () => void, signal: AbortSignal) {
    const root = this.#root;
    root.role = "img";
    const onMove = (x: number | null) => {
      this.#pointer = x;
      redraw();
    };
    const onSize = (size: Surface) => {
      this.#size = size;
      redraw();
    };
    this.#open = () => {
      picture.after(root);
      on(root, "pointermove", (event) => onMove(pointIn(root, event).x), signal);
      on(root, "pointerleave", () => onMove(null), signal);
      watchSize(root, onSize, signal);
      return new Canvas(root);
    };
  }

  /**
   * @param lines null to hide them
   * @param end text at the right end: "now"
   */
  draw(lines: TimeLine[] | null, seconds: number, end: string, theme: Theme, ratio: number): void {
    setHidden(this.#root, !lines);
    if (!lines) return;
    this.#canvas ??= this.#open();
    this.#root.style.height = `${lines.length * ROW + FOOT}px`;
    set(this.#root, "ariaLabel", `the last ${seconds} s of ${lines.map(({ name }) => name).join(", ")}`);
    if (!this.#size.width) return;
    const context = this.#canvas.begin({ ...this.#size, ratio });
    context.font = textFont(theme);
    context.lineJoin = "round";
    const left = Math.max(NAMES, ...lines.map(({ label }) => context.measureText(label).width + 16));
    const width = Math.max(1, this.#size.width - left - NUMBERS);
    const toX = (at: number) => left + width * (1 + at / (1000 * seconds));
    const inside = this.#pointer !== null && this.#pointer >= left && this.#pointer <= left + width;
    const pointed = inside ? (((this.#pointer as number) - left) / width - 1) * 1000 * seconds : null;
    for (const [row, shown] of lines.entries()) {
      drawRow(context, shown, { top: row * ROW + 4, height: ROW - 8, left, width }, toX, pointed, theme);
    }
    const y = lines.length * ROW + FOOT / 2 - 1;
    const font = textFont(theme);
    write(context, `\u2212${toFixed(seconds, 0)} s`, left, y, theme.muted, font, "left");
    write(context, end, left + width, y, theme.muted, font, "right");
    if (pointed === null) return;
    const x = toX(pointed);
    context.fillStyle = theme.ink;
    context.fillRect(Math.round(x), 0, 1, lines.length * ROW);
    const text = `${toFixed(pointed / 1000, 1)} s`;
    write(context, text, Math.min(left + width - 50, Math.max(left + 60, x)), y, theme.ink, font, "center");
  }
}

interface Band {
  top: number;
  height: number;
  left: number;
  width: number;
}

function drawRow(
  context: Context,
  { label, low, high, showsEnds, decimals, limits, color: hue, measured, commanded, over }: TimeLine,
  { top, height, left, width }: Band,
  toX: (at: number) => number,
  pointed: number | null,
  theme: Theme,
): void {
  const toY = (value: number) => top + height * (1 - Math.min(1, Math.max(0, (value - low) / (high - low))));
  const font = textFont(theme);
  context.fillStyle = theme.area;
  context.fillRect(left, top, width, height);
  write(context, label, left - 8, top + height / 2, theme.muted, font, "right");
  context.globalAlpha = 0.18;
  context.fillStyle = theme.reading;
  for (const [start, end] of over) context.fillRect(toX(start), top, Math.max(1, toX(end) - toX(start)), height);
  context.globalAlpha = 1;
  context.fillStyle = theme.line;
  if (low <= 0 && high >= 0) context.fillRect(left, Math.round(toY(0)), width, 1);
  context.setLineDash([3, 3]);
  for (const limit of limits) {
    const y = Math.round(toY(limit)) + 0.5;
    context.beginPath();
    line(context, { x: left, y }, { x: left + width, y });
    stroke(context, theme.muted, 1);
  }
  context.setLineDash([]);
  drawRuns(context, commanded, toX, toY, theme.ink, 1, true);
  drawRuns(context, measured, toX, toY, theme[hue], 1.75, false);
  for (const [start, end] of over) {
    const part = measured.filter(({ at }) => at >= start && at <= end);
    drawRuns(context, part, toX, toY, theme.reading, 1.75, false);
  }
  if (showsEnds) {
    write(context, toFixed(high, decimals), left + width + 8, top + 4, theme.muted, font, "left");
    write(context, toFixed(low, decimals), left + width + 8, top + height - 4, theme.muted, font, "left");
  }
  const shown = pointAt(measured.some(({ value }) => !Number.isNaN(value)) ? measured : commanded, pointed ?? 0);
  if (!shown) return;
  const isPast = over.some(([start, end]) => shown.at >= start && shown.at <= end);
  const color = isPast ? theme.reading : theme.ink;
  const text = Number.isNaN(shown.value) ? "\u2014" : toFixed(shown.value, decimals);
  write(context, text, left + width + 8, top + height / 2, color, `600 12px ${theme.font}`, "left");
}

/** Lines through runs of points; a command holds until the next, and is drawn as steps. */
function drawRuns(
  context: Context,
  points: Point[],
  toX: (at: number) => number,
  toY: (value: number) => number,
  color: string,
  width: number,
  isStepped: boolean,
): void {
  context.beginPath();
  for (const run of toRuns(points)) {
    for (const [i, { at, value }] of run.entries()) {
      if (i === 0) context.moveTo(toX(at), toY(value));
      else if (isStepped) context.lineTo(toX(at), toY(run[i - 1]?.value ?? value));
      context.lineTo(toX(at), toY(value));
    }
  }
  stroke(context, color, width);
}
