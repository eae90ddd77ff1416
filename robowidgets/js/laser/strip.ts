import { Canvas, type Surface, watchSize, write } from "../shared/canvas.ts";
import { make, pointIn, set } from "../shared/dom.ts";
import { toShortMetres } from "../shared/format.ts";
import { angleOf } from "../shared/frames/scan.ts";
import type { Theme } from "../shared/theme.ts";
import { watchGestures } from "./gestures.ts";
import { type Host, type Layer, LOWER, type StripStage, UPPER } from "./layer.ts";
import type { Place } from "./pick.ts";
import { indexTicks, metreTicks, placeOf, plotBox, toPicture, toX, toY } from "./strip_axis.ts";

const TEXT = 11;

/**
 * The index view below the picture: distance over index, as the program sees the array.
 *
 * An action of the user in it is passed on at the same ray and distance of the picture, so that every layer takes it.
 */
export class Strip {
  readonly root = make("div", "rw-strip");
  readonly #host: Host;
  readonly #layers: Layer[];
  readonly #canvas: Canvas;
  #size: Surface = { width: 0, height: 0, ratio: 1 };

  constructor(host: Host, layers: Layer[], signal: AbortSignal) {
    this.#host = host;
    this.#layers = layers;
    this.root.role = "img";
    this.#canvas = new Canvas(this.root);
    host.card.picture.after(this.root);
    watchGestures(this.root, layers, null, signal, (event) => this.#toPicture(event));
    watchSize(
      this.root,
      (size) => {
        this.#size = size;
        this.draw();
      },
      signal,
    );
  }

  draw(): void {
    const { stage, card } = this.#host;
    // At the pixel ratio of the picture.
    const size = { ...this.#size, ratio: card.size.ratio };
    const { width, height } = size;
    if (!width) return;
    const { scan, sweep, projection } = stage;
    const { theme } = card;
    const context = this.#canvas.begin(size);
    const axes = { box: plotBox(width, height), count: sweep.count, viewRange: projection.viewRange };
    const strip: StripStage = {
      ...axes,
      scan,
      size,
      xOf: (index) => toX(axes, index),
      yOf: (metres) => toY(axes, metres),
    };
    set(this.root, "ariaLabel", `distance over index, [0] to [${sweep.count - 1}]`);
    const painters = this.#layers.map((layer) => layer.strip?.() ?? {});
    const paint = (depths: readonly (keyof (typeof painters)[number])[]) => {
      for (const depth of depths) for (const one of painters) one[depth]?.(context, strip, theme);
    };
    const { x, y } = axes.box;
    context.fillStyle = theme.area;
    context.fillRect(x, y, axes.box.width, axes.box.height);
    paint(LOWER);
    drawAxes(context, strip, [angleOf(sweep, 0), angleOf(sweep, Math.max(0, sweep.count - 1))], theme);
    paint(UPPER);
  }

  /** The ray under the pointer, and the place of its distance there in the picture. */
  #toPicture(event: MouseEvent): Place {
    const { x, y } = pointIn(this.root, event);
    const { sweep, projection } = this.#host.stage;
    const axes = {
      box: plotBox(this.#size.width, this.#size.height),
      count: sweep.count,
      viewRange: projection.viewRange,
    };
    return toPicture(axes, sweep, projection, { x, y });
  }
}

function drawAxes(context: CanvasRenderingContext2D, strip: StripStage, ends: [number, number], theme: Theme): void {
  const { box, count, size } = strip;
  const [font, mono] = [`${TEXT}px ${theme.font}`, `${TEXT}px ${theme.mono}`];
  const bottom = box.y + box.height;
  for (const metres of metreTicks(strip)) {
    const y = Math.round(strip.yOf(metres)) + 0.5;
    context.fillStyle = theme.guide;
    context.fillRect(box.x, y - 0.45, box.width, 0.9);
    write(context, toShortMetres(metres), box.x - 8, y, theme.muted, font, "right");
  }
  for (const index of indexTicks(strip)) {
    const x = strip.xOf(index);
    context.fillStyle = theme.guide;
    context.fillRect(x - 0.5, bottom, 1, 5);
    const half = context.measureText(`[${index}]`).width / 2;
    const middle = Math.min(size.width - 6 - half, Math.max(half + 6, x));
    write(context, `[${index}]`, middle, bottom + 11, theme.muted, mono, "center");
  }
  if (!count) return;
  write(context, placeOf(ends[0]), box.x, size.height - 8, theme.muted, font, "left");
  write(context, placeOf(ends[1]), box.x + box.width, size.height - 8, theme.muted, font, "right");
}
