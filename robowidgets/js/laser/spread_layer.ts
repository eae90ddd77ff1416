import { toFixed } from "../shared/format.ts";
import { angleOf, type Scan } from "../shared/frames/scan.ts";
import type { Model } from "../shared/model.ts";
import { toPixel } from "../shared/projection.ts";
import type { Stream } from "../shared/stream.ts";
import type { Theme } from "../shared/theme.ts";
import type { Depth, Layer, Painter, Stage, StripPainter, StripStage } from "./layer.ts";
import { type Spread, spreadAt, spreadOf } from "./spread.ts";
import type { LaserTraits } from "./traits.ts";

/** The scatter of the readings of each ray: a bar along the ray, and a band in the index view. */
export class SpreadLayer implements Layer {
  readonly traits = ["spread"] as const;
  readonly #model: Model<LaserTraits>;
  readonly #stream: Stream<Scan>;
  #known: { scans: Scan[]; spread: Spread } | null = null;

  constructor(model: Model<LaserTraits>, stream: Stream<Scan>) {
    this.#model = model;
    this.#stream = stream;
  }

  painters(): Partial<Record<Depth, Painter>> {
    const spread = this.#spread;
    return spread ? { ghost: (context, stage, theme) => drawBars(context, stage, spread, theme) } : {};
  }

  strip(): Partial<Record<Depth, StripPainter>> {
    const spread = this.#spread;
    return spread ? { ghost: (context, strip, theme) => drawBand(context, strip, spread, theme) } : {};
  }

  /** "spread ±0.012 m in 50 scans", of a ray; "" if it is unknown. */
  readonly wordsOf = (index: number): string => {
    const spread = this.#spread;
    const metres = spread ? spreadAt(spread, index) : NaN;
    return spread && metres >= 0 ? `spread \u00b1${toFixed(metres, 3)} m in ${spread.count} scans` : "";
  };

  /** Null unless enabled. */
  get #spread(): Spread | null {
    const count = this.#model.get("spread");
    if (!count) return null;
    const scans = this.#stream.last(count).map((moment) => this.#stream.frameOf(moment));
    const known = this.#known?.scans;
    if (known?.length !== scans.length || scans.some((scan, i) => scan !== known[i])) {
      this.#known = { scans, spread: spreadOf(scans) };
    }
    return this.#known?.spread ?? null;
  }
}

function drawBars(context: CanvasRenderingContext2D, stage: Stage, { low, high }: Spread, theme: Theme): void {
  const { scan, projection } = stage;
  if (!scan) return;
  context.beginPath();
  for (let i = 0; i < scan.count; i++) {
    const [near, far] = [low[i] as number, Math.min(high[i] as number, projection.viewRange)];
    if (!(near < far)) continue;
    const angle = angleOf(scan, i);
    const [from, to] = [toPixel(projection, near, angle), toPixel(projection, far, angle)];
    context.moveTo(from.x, from.y);
    context.lineTo(to.x, to.y);
  }
  context.strokeStyle = theme.guide;
  context.lineWidth = 1;
  context.stroke();
}

function drawBand(context: CanvasRenderingContext2D, strip: StripStage, { low, high }: Spread, theme: Theme): void {
  const { count, viewRange, xOf, yOf } = strip;
  context.beginPath();
  for (let i = 0; i < count; i++) {
    const [near, far] = [low[i] as number, Math.min(high[i] as number, viewRange)];
    if (!(near < far)) continue;
    const [left, top] = [xOf(i - 0.5), yOf(far)];
    context.rect(left, top, xOf(i + 0.5) - left, yOf(near) - top);
  }
  context.globalAlpha = 0.5;
  context.fillStyle = theme.ghost;
  context.fill();
  context.globalAlpha = 1;
}
