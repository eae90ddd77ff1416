import type { Point } from "../shared/box.ts";
import { angleOf, TOO_CLOSE } from "../shared/frames/scan.ts";
import type { Lamps } from "../shared/lamps.ts";
import { toDirection } from "../shared/projection.ts";
import type { Theme } from "../shared/theme.ts";
import type { Lamp } from "../shared/traits.ts";
import type { Depth, Layer, Painter, Stage, StripPainter, StripStage } from "./layer.ts";

/** Pixels from a reading to the line behind it. */
const BEHIND = 5;
const WIDTH = 2.25;
/** Half the length of the line behind a single ray, in pixels. */
const HALF = 3;
/** Neighbours farther apart, in pixels, are separate things. */
const APART = 14;
/** Pixels from the scanner to the mark of a ray that is too close. */
const INNER = 17;
/** Height of the bar at the foot of the index view, in pixels. */
const FOOT = 3.5;

/** Runs of rays, each [first, stop), that made a lit condition true. */
export function litRuns(lamps: Lamp[]): [number, number][] {
  return lamps.flatMap(({ state, rays }) => {
    const count = state === "true" ? rays.length / 2 : 0;
    return Array.from({ length: count }, (_, i) => [rays[2 * i], rays[2 * i + 1]] as [number, number]);
  });
}

/** Lines just behind the readings of some runs of rays, in pixels; a single point has a short line. */
export function linesBehind({ scan, projection }: Pick<Stage, "scan" | "projection">, runs: [number, number][]) {
  const lines: Point[][] = [];
  if (!scan) return lines;
  const scale = projection.radius / projection.viewRange;
  const isShown = (i: number) => {
    return scan.kinds[i] === TOO_CLOSE || (scan.ranges[i] as number) <= projection.viewRange;
  };
  for (const [first, stop] of runs) {
    let line: (Point & { direction: Point })[] = [];
    const end = () => {
      const [only] = line;
      if (line.length === 1 && only) {
        const { x, y } = only.direction;
        const [a, b] = [-HALF, HALF].map((along) => ({ x: only.x - y * along, y: only.y + x * along }));
        lines.push([a as Point, b as Point]);
      } else if (line.length) lines.push(line);
      line = [];
    };
    for (let i = Math.max(0, first); i < Math.min(stop, scan.count); i++) {
      if (!isShown(i)) {
        end();
        continue;
      }
      const direction = toDirection(angleOf(scan, i), projection.forward);
      const distance = (scan.kinds[i] === TOO_CLOSE ? INNER : (scan.ranges[i] as number) * scale) + BEHIND;
      const point = {
        x: projection.centerX + direction.x * distance,
        y: projection.centerY + direction.y * distance,
        direction,
      };
      const before = line.at(-1);
      if (before && Math.hypot(point.x - before.x, point.y - before.y) > APART) end();
      line.push(point);
    }
    end();
  }
  return lines;
}

/** Underlines the rays that made a condition true. */
export class ConditionLayer implements Layer {
  readonly traits = [] as const;
  readonly #lamps: Lamps;
  readonly #painters: Partial<Record<Depth, Painter>> = {
    conditions: (context, stage, theme) => this.#draw(context, stage, theme),
  };

  constructor(lamps: Lamps) {
    this.#lamps = lamps;
  }

  painters(): Partial<Record<Depth, Painter>> {
    return this.#lamps.verdicts.length ? this.#painters : {};
  }

  strip(): Partial<Record<Depth, StripPainter>> {
    return { conditions: (context, strip, theme) => this.#drawFoot(context, strip, theme) };
  }

  /** A bar at the foot of the index view, under the rays that made a condition true. */
  #drawFoot(context: CanvasRenderingContext2D, { box, count, xOf }: StripStage, theme: Theme): void {
    context.fillStyle = theme.ink;
    for (const [first, stop] of litRuns(this.#lamps.verdicts)) {
      const [left, right] = [xOf(first - 0.5), xOf(Math.min(stop, count) - 0.5)];
      context.fillRect(left, box.y + box.height - FOOT, Math.max(FOOT, right - left), FOOT);
    }
  }

  #draw(context: CanvasRenderingContext2D, stage: Stage, theme: Theme): void {
    context.beginPath();
    for (const line of linesBehind(stage, litRuns(this.#lamps.verdicts))) {
      for (const [i, { x, y }] of line.entries()) {
        if (i) context.lineTo(x, y);
        else context.moveTo(x, y);
        stage.occupied.mark(x, y);
      }
    }
    context.lineWidth = WIDTH;
    context.lineCap = context.lineJoin = "round";
    context.strokeStyle = theme.ink;
    context.stroke();
    context.lineCap = "butt";
  }
}
