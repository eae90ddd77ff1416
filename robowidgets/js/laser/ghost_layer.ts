import { write } from "../shared/canvas.ts";
import { toFixed } from "../shared/format.ts";
import { angleOf, READING, type Scan } from "../shared/frames/scan.ts";
import { toPixel } from "../shared/projection.ts";
import { type Theme, textFont } from "../shared/theme.ts";
import { difference, distanceOf, largest, matchRays } from "./difference.ts";
import type { Ghost } from "./ghost.ts";
import type { Depth, Layer, Painter, Stage, StripPainter, StripStage } from "./layer.ts";

/** Radius of a dot in pixels. */
const DOT = 1;
/** Pixels; a shorter difference is invisible. */
const SHORT = 3;

/** The scan that the one on show is compared with: gray dots under it, and the difference over the index. */
export class GhostLayer implements Layer {
  readonly traits = ["_ghost", "_ghost_ago"] as const;
  readonly #ghost: Ghost;

  constructor(ghost: Ghost) {
    this.#ghost = ghost;
  }

  painters(): Partial<Record<Depth, Painter>> {
    const { scan } = this.#ghost;
    if (!scan) return {};
    return { ghost: (context, stage, theme) => drawGhost(context, stage, scan, theme) };
  }

  strip(): Partial<Record<Depth, StripPainter>> {
    const then = this.#ghost.scan;
    if (!then) return {};
    const { words } = this.#ghost;
    return {
      ghost: (context, strip, theme) => {
        if (strip.scan) drawDifference(context, strip, strip.scan, then, theme);
      },
      words: (context, strip, theme) => {
        if (strip.scan) drawWords(context, strip, strip.scan, difference(strip.scan, then), words, theme);
      },
    };
  }

  onKey({ key }: KeyboardEvent): boolean {
    if (key !== "g") return false;
    this.#ghost.toggle();
    return true;
  }
}

function drawGhost(context: CanvasRenderingContext2D, { projection, occupied }: Stage, scan: Scan, theme: Theme): void {
  context.fillStyle = theme.ghost;
  for (let i = 0; i < scan.count; i++) {
    const range = scan.ranges[i] as number;
    if (scan.kinds[i] !== READING || range > projection.viewRange) continue;
    const { x, y } = toPixel(projection, range, angleOf(scan, i));
    context.fillRect(x - DOT, y - DOT, 2 * DOT, 2 * DOT);
    occupied.mark(x, y);
  }
}

/** Draws dots of the other scan at the same rays, and the differences between them and the present readings. */
function drawDifference(
  context: CanvasRenderingContext2D,
  { viewRange, xOf, yOf }: StripStage,
  now: Scan,
  then: Scan,
  theme: Theme,
): void {
  const match = matchRays(now, then);
  const seen = (scan: Scan, index: number) => {
    const metres = index < 0 ? NaN : distanceOf(scan, index);
    return metres <= viewRange ? yOf(metres) : NaN;
  };
  const half = Math.max(1, xOf(1) - xOf(0)) / 2;
  const dots: [number, number][] = [];
  let run: [x: number, now: number, then: number][] = [];
  // One outline for neighbours: a line for each ray takes several times as long.
  const traceRun = () => {
    const [[left, a, b] = [0, 0, 0], [right, c, d] = [0, 0, 0]] = [run[0], run.at(-1)];
    if (run.length) {
      context.moveTo(left - half, b);
      context.lineTo(left - half, a);
      for (const [x, y] of run) context.lineTo(x, y);
      context.lineTo(right + half, c);
      context.lineTo(right + half, d);
      for (const [x, , y] of run.reverse()) context.lineTo(x, y);
      context.closePath();
    }
    run = [];
  };
  context.beginPath();
  for (let i = 0; i < now.count; i++) {
    const [x, a, b] = [xOf(i), seen(now, i), seen(then, match(i))];
    if (!Number.isNaN(b)) dots.push([x, b]);
    if (Math.abs(a - b) >= SHORT) run.push([x, a, b]);
    else traceRun();
  }
  traceRun();
  context.globalAlpha = 0.25;
  context.fillStyle = theme.ghost;
  context.fill();
  context.globalAlpha = 1;
  for (const [x, y] of dots) context.fillRect(x - DOT, y - DOT, 2 * DOT, 2 * DOT);
}

/** "−0.32 m at [568]", of the largest difference. */
export function largestWords(differences: Float32Array): string {
  const index = largest(differences);
  const value = differences[index] ?? 0;
  return index < 0 ? "" : `${value > 0 ? "+" : ""}${toFixed(value, 2)} m at [${index}]`;
}

/** Under the strip: the source of the gray scan, and the largest difference, which is marked in the plot. */
function drawWords(
  context: CanvasRenderingContext2D,
  { box, size, viewRange, xOf, yOf }: StripStage,
  now: Scan,
  differences: Float32Array,
  source: string,
  theme: Theme,
): void {
  const index = largest(differences);
  if (index >= 0) {
    const metres = distanceOf(now, index);
    const [top, bottom] = [metres, metres - (differences[index] as number)]
      .map((one) => yOf(Math.min(viewRange, one)))
      .sort((a, b) => a - b) as [number, number];
    const x = xOf(index);
    context.fillStyle = theme.ink;
    context.fillRect(x - 0.75, top, 1.5, bottom - top);
    for (const y of [top, bottom]) context.fillRect(x - 3.5, y - 0.75, 7, 1.5);
  }
  const most = largestWords(differences);
  const font = textFont(theme);
  context.font = font;
  const parts: [string, string][][] = [
    [
      ["\u25a0 ", theme.reading],
      ["now  ", theme.muted],
      ["\u25cf ", theme.ghost],
      [source, theme.muted],
      [most && " \u00b7 largest ", theme.muted],
      [most, theme.ink],
    ],
    [
      ["\u25cf ", theme.ghost],
      [source, theme.muted],
      [most && " \u00b7 ", theme.muted],
      [most, theme.ink],
    ],
    [[most || source, theme.ink]],
  ];
  const widthOf = (texts: [string, string][]) => context.measureText(texts.map(([text]) => text).join("")).width;
  // The words at both ends need room, too.
  const texts = parts.find((one) => widthOf(one) <= box.width - 130) ?? [];
  let x = box.x + box.width / 2 - widthOf(texts) / 2;
  for (const [text, color] of texts) {
    write(context, text, x, size.height - 8, color, font, "left");
    x += context.measureText(text).width;
  }
}
