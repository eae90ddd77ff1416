import type { Point } from "../shared/box.ts";
import { onAbort } from "../shared/events.ts";
import type { Projection } from "../shared/projection.ts";
import { drawShape, pathOf, WIDTH } from "../shared/shapes/draw.ts";
import { type Metres, placesOf } from "../shared/shapes/places.ts";
import type { Theme } from "../shared/theme.ts";
import type { About, Shape } from "../shared/traits.ts";
import type { Depth, Host, Layer, Painter, Stage } from "./layer.ts";
import { shownBy } from "./mount.ts";
import { ShapeLabels } from "./shape_labels.ts";
import { describeShape, lasting, readingOf, toPicture, untilNext } from "./shapes.ts";

/** A shape that can be drawn now, and its places in metres. */
export interface Placed {
  shape: Shape;
  places: Metres[];
}

/** The shapes that the program drew on the scan on show. */
export class ShapeLayer implements Layer {
  readonly traits = ["angle_unit", "own_angles"] as const;
  readonly #host: Host;
  readonly #labels = new ShapeLabels();
  /** The facts about the newest sample, and the time of their arrival in milliseconds of the page's clock. */
  #newest: { about: About; at: number } | null = null;
  /** The shapes that were drawn last, with points of the picture along them. */
  #drawn: (Placed & { path: Point[] })[] = [];
  #timer: ReturnType<typeof setTimeout> | undefined;
  readonly #painters: Partial<Record<Depth, Painter>> = {
    shapes: (context, stage, theme) => this.#drawShapes(context, stage, theme),
    words: (context, stage, theme) => this.#drawLabels(context, stage, theme),
  };

  constructor(host: Host) {
    this.#host = host;
    onAbort(host.signal, () => clearTimeout(this.#timer));
  }

  painters(): Partial<Record<Depth, Painter>> {
    return this.#shapes.length ? this.#painters : {};
  }

  place(): void {
    clearTimeout(this.#timer);
    const { about, paused } = this.#host.stream;
    const wait = paused ? Infinity : untilNext(about.shapes ?? [], this.#age(about));
    if (Number.isFinite(wait)) this.#timer = setTimeout(() => this.#host.card.redraw(), wait + 1);
  }

  /** A frozen picture shows the shapes of its scan, however old they are. */
  get #shapes(): Shape[] {
    const { about, paused } = this.#host.stream;
    const shapes = about.shapes ?? [];
    return paused ? shapes : lasting(shapes, this.#age(about));
  }

  /** Milliseconds since these facts arrived in the page. */
  #age(about: About): number {
    if (this.#newest?.about !== about) this.#newest = { about, at: performance.now() };
    return performance.now() - this.#newest.at;
  }

  #placed(stage: Stage): Placed[] {
    return this.#shapes.flatMap((shape) => {
      const places = placesOf(shape.at, (index) => readingOf(stage.scan, index));
      return places ? [{ shape, places }] : [];
    });
  }

  #drawShapes(context: CanvasRenderingContext2D, stage: Stage, theme: Theme): void {
    const { projection, occupied } = stage;
    const { centerX, centerY, radius } = projection;
    const toPoint = (place: Metres) => toPicture(projection, place);
    const isInView = ({ x, y }: Point) => Math.hypot(x - centerX, y - centerY) <= radius;
    this.#drawn = this.#placed(stage).map((one) => ({
      ...one,
      path: pathOf(toPoint, isInView, one.shape, one.places),
    }));
    for (const { x, y } of this.#drawn.flatMap(({ path }) => path)) occupied.mark(x, y);
    // One clip for all: a separate clip for each shape takes longer than everything else here.
    clipToView(context, projection, () => {
      for (const { shape, places } of this.#drawn) drawShape(context, toPoint, shape, places, theme);
    });
  }

  #drawLabels(context: CanvasRenderingContext2D, stage: Stage, theme: Theme): void {
    const named = new Set<string>();
    const { model, stream } = this.#host;
    const [unit, toShown] = [model.get("angle_unit"), shownBy(model, stream.about)];
    const labels = this.#drawn.flatMap(({ shape, places, path }) => {
      const isFirst = !named.has(shape.name);
      named.add(shape.name);
      if (shape.kind !== "text" && !isFirst) return [];
      const lines =
        shape.kind === "text"
          ? [shape.text ?? ""]
          : [shape.name, describeShape(shape, places, stage.projection.viewRange, unit, toShown)];
      return [{ shape, path, lines: lines.filter(Boolean) }];
    });
    this.#labels.draw(context, stage, labels, theme);
  }
}

/** Calls a function that draws only within the view: shapes beyond it would cover the labels round it. */
function clipToView(context: CanvasRenderingContext2D, projection: Projection, draw: () => void): void {
  context.save();
  context.beginPath();
  context.arc(projection.centerX, projection.centerY, projection.radius + WIDTH, 0, 2 * Math.PI);
  context.clip();
  draw();
  context.restore();
}
