import { make } from "../shared/dom.ts";
import type { Mark } from "../shared/marks.ts";
import { type Theme, textFont } from "../shared/theme.ts";
import type { Span } from "../shared/time_axis.ts";
import { timeTicks } from "../shared/time_span.ts";
import type { Rows } from "./frame.ts";
import { type Entry, type Group, toScale } from "./groups.ts";
import uPlot from "./uplot.ts";

/** Pixels for the numbers at the left, and for the times below. */
export const SCALE = 60;
export const TIMES = 26;
const TOP = 22;
/** Of each time on the axis, at least. */
const TIME_WIDTH = 75;
/** Height of the bar above a mark, and least width of the mark. */
const BAR = 3;
/** Width of a highlighted line. */
const LIT = 2.5;

/** The content of a chart. */
export interface Shown {
  rows: Rows[];
  span: Span;
  /** The longest time on the axis, which determines the form of times. */
  end: number;
  marks: Mark[];
  theme: Theme;
  width: number;
  height: number;
  /** Pixels at the right. */
  right: number;
}

/** One graph: the lines of a unit, drawn by uPlot. */
export class Chart {
  readonly root = make("div", "rw-plot-graph");
  readonly group: Group;
  readonly #plot: uPlot;
  readonly #isFirst: boolean;
  #shown: Shown;
  /** The line under the pointer in the legend, or null. */
  #lit: string | null = null;

  constructor(parent: HTMLElement, group: Group, isFirst: boolean, isLast: boolean, shown: Shown) {
    this.group = group;
    this.#isFirst = isFirst;
    this.#shown = shown;
    parent.append(this.root);
    const axis: uPlot.Axis = {
      stroke: () => this.#shown.theme.muted,
      grid: { stroke: () => this.#shown.theme.line, width: 1 },
      ticks: { stroke: () => this.#shown.theme.guide, width: 1, size: 4 },
      font: textFont(shown.theme),
      gap: 4,
    };
    this.#plot = new uPlot(
      {
        width: shown.width,
        height: shown.height,
        padding: [TOP, () => this.#shown.right, isLast ? 0 : 6, 0],
        legend: { show: false },
        cursor: { show: false },
        scales: { x: { time: false, range: () => this.#shown.span }, y: { range: toRange } },
        axes: [
          {
            ...axis,
            size: isLast ? TIMES : 0,
            ticks: { ...axis.ticks, show: isLast },
            splits: () => this.#times.map(({ time }) => time),
            values: () => this.#times.map(({ text }) => (isLast ? text : "")),
          },
          {
            ...axis,
            size: SCALE,
            ticks: { show: false },
            space: 28,
            values: (_, numbers, _axis, _space, step) => numbers.map((number) => toScale(number, step)),
          },
        ],
        series: [
          {},
          ...group.entries.map((entry): uPlot.Series => {
            const ink = () => this.#inkOf(entry);
            return {
              stroke: ink,
              width: entry.pen.width,
              dash: entry.pen.dash,
              points: { size: 4, width: 1, stroke: ink, fill: ink },
              ...(entry.isStepped && uPlot.paths.stepped && { paths: uPlot.paths.stepped({ align: 1 }) }),
            };
          }),
        ],
        hooks: { drawClear: [() => this.#drawMarks()] },
      },
      this.#data(),
      this.root,
    );
  }

  /** Draws at once. */
  draw(shown: Shown): void {
    const { width, height } = this.#shown;
    this.#shown = shown;
    this.#plot.batch(() => {
      if (shown.width !== width || shown.height !== height) this.#plot.setSize(shown);
      this.#plot.setData(this.#data());
    });
  }

  /** Draws a highlighted line wider, and the others in gray; null to highlight none. */
  light(name: string | null): void {
    const isIn = this.group.entries.some((entry) => entry.name === name);
    const lit = isIn ? name : null;
    if (lit === this.#lit) return;
    this.#lit = lit;
    for (const [i, { name: own, pen }] of this.group.entries.entries()) {
      const series = this.#plot.series[i + 1];
      if (series) series.width = own === lit ? LIT : pen.width;
    }
    this.#plot.redraw(false);
  }

  #inkOf({ name, isGhost }: Entry): string {
    const { theme } = this.#shown;
    if (this.#lit !== null && this.#lit !== name) return theme.guide;
    return isGhost ? theme.ghost : theme.ink;
  }

  /** The place of the graph, in pixels of the picture. */
  get box(): { left: number; top: number; width: number; height: number } {
    const { offsetLeft: left, offsetTop: top, offsetWidth: width, offsetHeight: height } = this.#plot.over;
    return { left: this.root.offsetLeft + left, top: this.root.offsetTop + top, width, height };
  }

  /** The height of a value in the picture, within the graph. */
  toY(value: number): number {
    const { top, height } = this.box;
    return top + Math.min(height, Math.max(0, this.#plot.valToPos(value, "y")));
  }

  close(): void {
    this.#plot.destroy();
    this.root.remove();
  }

  get #times(): { time: number; text: string }[] {
    const { span, end, width, right } = this.#shown;
    return timeTicks(span, Math.max(1, (width - SCALE - right) / TIME_WIDTH), end);
  }

  /** The times of all lines, with null in gaps, and undefined at times of other lines. */
  #data(): uPlot.AlignedData {
    const tables = this.#shown.rows.map(({ times, values }): [number[], (number | null)[]] => [
      [...times],
      Array.from(values, (value) => (Number.isNaN(value) ? null : value)),
    ]);
    return tables.length === 1 ? (tables[0] as uPlot.AlignedData) : uPlot.join(tables);
  }

  #drawMarks(): void {
    const { marks, span, theme } = this.#shown;
    const { ctx, bbox } = this.#plot;
    const ratio = uPlot.pxRatio;
    for (const [start, end] of marks) {
      if (end < span[0] || start > span[1]) continue;
      const [from, to] = [start, end].map((time) => {
        const x = this.#plot.valToPos(time, "x", true);
        return Math.min(bbox.left + bbox.width, Math.max(bbox.left, x));
      }) as Span;
      const width = Math.max(BAR * ratio, to - from);
      ctx.save();
      ctx.fillStyle = theme.ink;
      if (this.#isFirst) ctx.fillRect(from, bbox.top - (BAR + 1) * ratio, width, BAR * ratio);
      ctx.globalAlpha = 0.07;
      ctx.fillRect(from, bbox.top, width, bbox.height);
      ctx.restore();
    }
  }
}

/** The scale of the least and the greatest value; both are null if there are no values. */
function toRange(_: uPlot, least: number | null, most: number | null): uPlot.Range.MinMax {
  if (least === null || most === null) return [null, null];
  // A line at zero would lie at the bottom of a scale up to 100.
  return least === 0 && most === 0 ? [-1, 1] : uPlot.rangeNum(least, most, 0.1, true);
}
