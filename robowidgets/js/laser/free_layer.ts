import type { Point } from "../shared/box.ts";
import { angleOf, NOTHING_IN_RANGE, READING, type Scan } from "../shared/frames/scan.ts";
import type { Model } from "../shared/model.ts";
import { toPixel } from "../shared/projection.ts";
import type { Stream } from "../shared/stream.ts";
import type { Theme } from "../shared/theme.ts";
import type { Depth, Layer, Painter, Stage } from "./layer.ts";
import type { LaserTraits } from "./traits.ts";

/**
 * The space that the scanner has seen to be free: from the robot to each reading, and to the rim if nothing was in
 * range.
 */
export class FreeLayer implements Layer {
  readonly traits = ["free_space"] as const;
  readonly #model: Model<LaserTraits>;
  readonly #stream: Stream<Scan>;
  readonly #painters: Partial<Record<Depth, Painter>> = {
    free: (context, stage, theme) => this.#draw(context, stage, theme),
  };

  constructor(model: Model<LaserTraits>, stream: Stream<Scan>) {
    this.#model = model;
    this.#stream = stream;
  }

  painters(): Partial<Record<Depth, Painter>> {
    return this.#model.get("free_space") ? this.#painters : {};
  }

  /** Each scan has another free space. */
  lowerKey(): unknown {
    return this.#model.get("free_space") && this.#stream.shown?.sequence;
  }

  #draw(context: CanvasRenderingContext2D, stage: Stage, theme: Theme): void {
    context.beginPath();
    for (const outline of freeOutlines(stage)) {
      context.moveTo(stage.projection.centerX, stage.projection.centerY);
      for (const { x, y } of outline) context.lineTo(x, y);
      context.closePath();
    }
    context.fillStyle = theme.seen;
    context.fill();
  }
}

/**
 * Outlines of free space without the scanner's place, in pixels: one for each run of rays with a distance. A ray that
 * is not measured, too close or outside the limits shows no free space. Each ray stands for half of the angle to its
 * neighbours.
 */
export function freeOutlines({ scan, projection }: Pick<Stage, "scan" | "projection">): Point[][] {
  const outlines: Point[][] = [];
  if (!scan) return outlines;
  const half = Math.abs(scan.angleIncrement) < Math.PI / 4 ? scan.angleIncrement / 2 : 0.01;
  let outline: Point[] = [];
  for (let i = 0; i <= scan.count; i++) {
    const kind = scan.kinds[i];
    if (kind !== READING && kind !== NOTHING_IN_RANGE) {
      if (outline.length) outlines.push(outline);
      outline = [];
      continue;
    }
    const seen = kind === READING ? (scan.ranges[i] as number) : scan.maxRange;
    const distance = Math.min(seen, scan.maxRange, projection.viewRange);
    for (const side of [-half, half]) outline.push(toPixel(projection, distance, angleOf(scan, i) + side));
  }
  return outlines;
}
