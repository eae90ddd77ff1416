import { onAbort } from "../shared/events.ts";
import { angleOf } from "../shared/frames/scan.ts";
import { type Lit, onLight, pointAtRays } from "../shared/lit.ts";
import { onChange } from "../shared/model.ts";
import { toDirection } from "../shared/projection.ts";
import type { Theme } from "../shared/theme.ts";
import type { Depth, Host, Layer, Painter, Stage, StripPainter } from "./layer.ts";

/** Pixels of the ring round the reading that decided. */
const RING = 5;
const PALE = 0.35;

/**
 * The rays that the line of a program read, while the user points at it in the widget of the program's lines. It tells
 * that widget at which rays the user points here.
 */
export class LitLayer implements Layer {
  readonly traits = [] as const;
  #lit: Lit[] = [];
  readonly #painters: Partial<Record<Depth, Painter>> = {
    conditions: (context, stage, theme) => this.#drawRays(context, stage, theme),
    rings: (context, stage, theme) => this.#drawNearest(context, stage, theme),
  };

  constructor({ model, stream, card, signal }: Host) {
    // In the player of a recording, its group stands for the robot.
    const robot = () => stream.robot || stream.group;
    const tell = () => {
      const indices = [model.get("pinned"), model.get("hovered")].filter((index) => index !== null);
      const { frame_id: frame = "" } = stream.about;
      pointAtRays(
        this,
        robot(),
        indices.map((index) => ({ index, frame })),
      );
    };
    tell();
    onChange(model, ["pinned", "hovered"], tell, signal);
    onAbort(signal, () => pointAtRays(this, robot(), []));
    onLight(
      robot,
      (lit) => {
        // Of several lasers of a robot, only the one whose scan was read.
        const { frame_id = "" } = stream.about;
        this.#lit = lit.filter(({ frame }) => !frame || !frame_id || frame === frame_id);
        card.redraw();
      },
      signal,
    );
  }

  painters(): Partial<Record<Depth, Painter>> {
    return this.#lit.length ? this.#painters : {};
  }

  strip(): Partial<Record<Depth, StripPainter>> {
    if (!this.#lit.length) return {};
    return {
      conditions: (context, { box, count, xOf }, theme) => {
        context.fillStyle = theme.pointer;
        for (const [first, stop] of this.#runs(count)) {
          context.fillRect(xOf(first - 0.5), box.y, Math.max(1, xOf(stop - 0.5) - xOf(first - 0.5)), 2);
        }
      },
    };
  }

  #runs(count: number): [first: number, stop: number][] {
    return this.#lit.flatMap(({ runs }) =>
      Array.from({ length: runs.length / 2 }, (_, i) => {
        return [runs[2 * i] ?? 0, Math.min(runs[2 * i + 1] ?? 0, count)] as [number, number];
      }),
    );
  }

  #drawRays(context: CanvasRenderingContext2D, { scan, projection }: Stage, theme: Theme): void {
    if (!scan) return;
    const { centerX, centerY } = projection;
    context.beginPath();
    for (const [first, stop] of this.#runs(scan.count)) {
      for (let i = first; i < stop; i++) {
        const { x, y } = pointOf(i, scan, projection);
        context.moveTo(centerX, centerY);
        context.lineTo(x, y);
      }
    }
    context.globalAlpha = PALE;
    context.lineWidth = 1;
    context.strokeStyle = theme.pointer;
    context.stroke();
    context.globalAlpha = 1;
  }

  #drawNearest(context: CanvasRenderingContext2D, { scan, projection }: Stage, theme: Theme): void {
    for (const { nearest } of this.#lit) {
      if (!scan || nearest < 0 || nearest >= scan.count) continue;
      const { x, y } = pointOf(nearest, scan, projection);
      context.beginPath();
      context.moveTo(projection.centerX, projection.centerY);
      context.lineTo(x, y);
      context.moveTo(x + RING, y);
      context.arc(x, y, RING, 0, 2 * Math.PI);
      context.lineWidth = 2;
      context.strokeStyle = theme.pointer;
      context.stroke();
    }
  }
}

/** Returns the reading of a ray in pixels, or the edge of the picture if it has no reading. */
function pointOf(i: number, scan: NonNullable<Stage["scan"]>, projection: Stage["projection"]) {
  const direction = toDirection(angleOf(scan, i), projection.forward);
  const range = scan.ranges[i] as number;
  const share = Number.isFinite(range) ? Math.min(1, Math.max(0, range / projection.viewRange)) : 1;
  const away = share * projection.radius;
  return { x: projection.centerX + direction.x * away, y: projection.centerY + direction.y * away };
}
