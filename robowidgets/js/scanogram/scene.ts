import { Canvas, type Surface } from "../shared/canvas.ts";
import { zoomOf } from "../shared/dom.ts";
import {
  cutName,
  drawActive,
  drawStates,
  machineOf,
  nameOf,
  type StateSpan,
  statesAt,
  type Tones,
} from "../shared/states/states.ts";
import type { Theme } from "../shared/theme.ts";
import { type Span, type TimeAxis, toX } from "../shared/time_axis.ts";
import type { Whole } from "./data.ts";
import { drawAngles, drawFrame, drawTimes, drawTriangle } from "./draw_axes.ts";
import { drawLabel, drawSpans, drawSpeed, drawTouches } from "./draw_strips.ts";
import { type Band, type Layout, layOut } from "./layout.ts";
import { toRaster } from "./paint.ts";
import { toPalette } from "./palette.ts";
import { type Rows, toRows } from "./rows.ts";
import type { State } from "./state.ts";

const NO_ROWS: Rows = { rayOf: [], angles: [], rowOf: [], byAngle: false };

/** The place of the pointer: in a row, or below the scans. */
export interface Pointed {
  time: number;
  row: number | null;
}

/**
 * The canvases of one view: the lower one for the scans and strips, the upper one for the pointer and the selection.
 */
export class Scene {
  layout: Layout = layOut({ width: 0, height: 0 }, null, 0);
  axis: TimeAxis = { span: [0, 1], left: 0, width: 1 };
  rows = NO_ROWS;
  /** Metres of the nearest and the farthest colour. */
  colors: [number, number] = [0, 1];
  readonly #base: Canvas;
  readonly #top: Canvas;
  readonly #pixels = document.createElement("canvas");
  #size: Surface = { width: 0, height: 0, ratio: 1 };
  #whole: Whole | null = null;
  #states: StateSpan[][] = [];
  readonly #tones: Tones = new Map();
  #palette: { key: string; colors: Uint32Array } | null = null;

  constructor(parent: HTMLElement) {
    this.#base = new Canvas(parent);
    this.#top = new Canvas(parent);
  }

  /** Pixels of the screen per pixel: fewer than a PNG has. */
  get #ratio(): number {
    return devicePixelRatio * zoomOf(this.#base.context.canvas);
  }

  /** Columns of the picture on the screen. */
  get columns(): number {
    return Math.round(this.layout.width * this.#ratio);
  }

  measure(size: Surface, whole: Whole | null, states: StateSpan[][], span: Span, notice: number): void {
    this.#states = states;
    this.#size = size;
    if (whole !== this.#whole) {
      this.#whole = whole;
      this.rows = whole ? toRows(whole.sweep) : NO_ROWS;
      this.#palette = null;
    }
    this.layout = layOut(size, whole, notice, states.length);
    this.axis = { span, left: this.layout.left, width: this.layout.width };
  }

  drawBase(state: State, theme: Theme): void {
    const context = this.#base.begin(this.#size);
    const { whole, blocks } = state;
    const { layout, axis, rows } = this;
    context.fillStyle = theme.area;
    if (!whole || !blocks) context.fillRect(layout.left, layout.scans.top, layout.width, layout.scans.height);
    drawFrame(context, layout, theme);
    if (!whole || !blocks) return;
    const height = Math.round(layout.scans.height * this.#ratio);
    const raster = toRaster(blocks.all, rows, axis.span, this.columns, height, state.pixel);
    this.colors = state.colors ?? whole.colors;
    const palette = this.#paletteFor(whole, this.colors, theme);
    const image = new ImageData(raster.width, raster.height);
    const pixels = new Uint32Array(image.data.buffer);
    for (let i = 0; i < pixels.length; i++) pixels[i] = palette[raster.codes[i] as number] as number;
    this.#pixels.width = raster.width;
    this.#pixels.height = raster.height;
    this.#pixels.getContext("2d")?.putImageData(image, 0, 0);
    context.imageSmoothingEnabled = false;
    context.drawImage(this.#pixels, layout.left, layout.scans.top, layout.width, layout.scans.height);
    drawAngles(context, rows, layout, theme);
    drawSpans(context, axis, layout.marks, state.marks, theme.ink, 0.4);
    const speeds = blocks.speedsIn(axis.span);
    for (const [i, band] of layout.speeds.entries()) {
      if (whole.speed && speeds) drawSpeed(context, axis, band, whole.speed, speeds, i, theme);
    }
    if (layout.touch && whole.touch) {
      drawTouches(context, axis, layout.touch, whole.touch.spans, theme);
    }
    for (const [band, row] of this.#stateRows()) {
      drawLabel(context, band, layout.left, cutName(context, machineOf(row), layout.left - 12, theme), theme);
      drawStates(context, axis, band.top, row, this.#tones, theme);
    }
  }

  /**
   * Draws the selection, and one line through all at the moment under the pointer, or at the time cursor; on it a ring
   * at the ray under the pointer, here or on another widget.
   */
  drawTop(time: number, selection: number[] | null, pointed: Pointed | null, theme: Theme): void {
    const context = this.#top.begin(this.#size);
    if (!this.#whole) return;
    const { layout, axis } = this;
    const { left, width, bottom } = layout;
    const line = pointed?.time ?? time;
    const active = statesAt(this.#states, line).at(-1);
    drawTimes(context, axis, layout, this.#whole.span[1], line, theme, active ? nameOf(active[2]) : "");
    context.save();
    context.beginPath();
    context.rect(left - 7, 0, width + 14, bottom + 4);
    context.clip();
    if (selection) this.#drawSelection(context, selection, theme);
    if (line !== time) this.#drawFlag(context, time, theme.muted, theme);
    this.#drawLine(context, line, theme);
    // Over the line, which would strike out their names.
    for (const [band, row] of this.#stateRows()) drawActive(context, axis, band.top, row, line, theme);
    this.#drawFlag(context, line, theme.ink, theme);
    const row = pointed?.row ?? null;
    if (row !== null) drawRing(context, toX(axis, line), this.toY(row), theme);
    context.restore();
  }

  #stateRows(): [Band, StateSpan[]][] {
    return this.layout.states.map((band, i) => [band, this.#states[i] ?? []]);
  }

  /** Draws the flag of the cursor while the pointer is elsewhere; the line itself has a flag in ink. */
  #drawFlag(context: CanvasRenderingContext2D, time: number, color: string, theme: Theme): void {
    const { left, width, scans } = this.layout;
    const x = toX(this.axis, time);
    if (x < left - 1 || x > left + width + 1) return;
    context.fillStyle = color;
    drawTriangle(context, x, scans.top - 1, scans.top - 9, 5.5);
    context.strokeStyle = theme.background;
    context.lineWidth = 1;
    context.stroke();
  }

  #drawLine(context: CanvasRenderingContext2D, time: number, theme: Theme): void {
    const { left, width, bottom, scans } = this.layout;
    const x = toX(this.axis, time);
    if (x < left - 1 || x > left + width + 1) return;
    context.fillStyle = theme.background;
    context.fillRect(x - 1.75, scans.top, 3.5, scans.height);
    context.fillStyle = theme.ink;
    context.fillRect(x - 0.75, scans.top - 2, 1.5, bottom + 4 - scans.top + 2);
  }

  /** The row at a height of the picture, from the bottom up; kept within the picture. */
  toRow(y: number): number {
    const { top, height } = this.layout.scans;
    const count = this.rows.rayOf.length;
    return Math.min(count - 1, Math.max(0, Math.floor((1 - (y - top) / height) * count)));
  }

  /** The middle of a row. */
  toY(row: number): number {
    const { top, height } = this.layout.scans;
    return top + (1 - (row + 0.5) / this.rows.rayOf.length) * height;
  }

  #drawSelection(context: CanvasRenderingContext2D, selection: number[], theme: Theme): void {
    const [start = 0, end = 0, first, stop] = selection;
    const { left, width, scans, bottom } = this.layout;
    const from = Math.max(left - 2, toX(this.axis, start));
    const to = Math.min(left + width + 2, toX(this.axis, end));
    if (to <= from) return;
    const boxes: [number, number][] = [];
    if (first === undefined || stop === undefined) {
      boxes.push([scans.top, bottom - scans.top]);
    } else {
      for (const [low, high] of runs(this.rows, first, stop)) {
        const top = this.toY(high) - scans.height / this.rows.rayOf.length / 2;
        boxes.push([top, this.toY(low) + scans.height / this.rows.rayOf.length / 2 - top]);
      }
    }
    for (const [top, height] of boxes) {
      context.globalAlpha = 0.16;
      context.fillStyle = theme.pointer;
      context.fillRect(from, top, to - from, height);
      context.globalAlpha = 1;
      context.beginPath();
      context.rect(from, top, to - from, height);
      strokeTwice(context, 3, 1.5, theme);
    }
  }

  #paletteFor(whole: Whole, colors: [number, number], theme: Theme): Uint32Array {
    const key = `${colors}${theme.dark}${theme.reading}`;
    if (this.#palette?.key !== key) this.#palette = { key, colors: toPalette(theme, whole.sweep, colors) };
    return this.#palette.colors;
  }
}

function drawRing(context: CanvasRenderingContext2D, x: number, y: number, theme: Theme): void {
  context.beginPath();
  context.arc(x, y, 4.5, 0, 2 * Math.PI);
  strokeTwice(context, 3.5, 2, theme);
}

/** Strokes a line that is visible on any colour. */
function strokeTwice(context: CanvasRenderingContext2D, outer: number, inner: number, theme: Theme): void {
  context.lineWidth = outer;
  context.strokeStyle = theme.background;
  context.stroke();
  context.lineWidth = inner;
  context.strokeStyle = theme.pointer;
  context.stroke();
}

/** The rows of a span of indices, as runs of lowest and highest row: a full circle may split them in two. */
export function runs({ rowOf }: Rows, first: number, stop: number): [number, number][] {
  const rows = rowOf.slice(first, stop).sort((a, b) => a - b);
  const found: [number, number][] = [];
  for (const row of rows) {
    const last = found.at(-1);
    if (last && row === last[1] + 1) last[1] = row;
    else found.push([row, row]);
  }
  return found;
}
