import { toCount, toShortMetres } from "../shared/format.ts";
import { CLASSES } from "../shared/frames/classes.ts";
import type { Scan } from "../shared/frames/scan.ts";
import type { Model } from "../shared/model.ts";
import type { Theme } from "../shared/theme.ts";
import { colorScale, type Domain, drawColorScale, intensityDomain, SCALE_HEIGHT } from "./color.ts";
import { drawBeyond, drawReadings } from "./draw_readings.ts";
import { drawStripReadings } from "./draw_strip.ts";
import type { Depth, Layer, Painter, Stage, StripPainter } from "./layer.ts";
import type { LaserTraits } from "./traits.ts";

/** The dots and marks of a scan, and the scale of their colours. */
export class ReadingLayer implements Layer {
  readonly traits = ["marks", "color_by_intensity"] as const;
  readonly #model: Model<LaserTraits>;
  readonly #painters: Partial<Record<Depth, Painter>> = {
    readings: (context, stage, theme) => this.#drawReadings(context, stage, theme),
    words: (context, stage, theme) => this.#drawWords(context, stage, theme),
  };
  #domain: Domain | null = null;
  #beyond = 0;

  constructor(model: Model<LaserTraits>) {
    this.#model = model;
  }

  painters(): Partial<Record<Depth, Painter>> {
    return this.#painters;
  }

  strip(): Partial<Record<Depth, StripPainter>> {
    return {
      readings: (context, strip, theme) => {
        const colorOf = this.#domain ? colorScale(this.#domain, theme.dark) : null;
        if (strip.scan) drawStripReadings(context, strip, strip.scan, theme, colorOf);
      },
    };
  }

  roomBelow(scan: Scan | null): number {
    const colored = scan?.intensities.length && this.#model.get("color_by_intensity");
    this.#domain = scan && colored ? intensityDomain(scan, this.#domain) : null;
    return this.#domain ? SCALE_HEIGHT : 0;
  }

  #drawReadings(context: CanvasRenderingContext2D, { scan, projection, occupied }: Stage, theme: Theme): void {
    if (!scan) return;
    const shown = new Set(this.#model.get("marks"));
    const marks = new Set(CLASSES.filter(({ name }) => shown.has(name)).map(({ kind }) => kind));
    const style = { theme, marks, colorOf: this.#domain ? colorScale(this.#domain, theme.dark) : null };
    this.#beyond = drawReadings(context, projection, scan, style, occupied);
  }

  #drawWords(context: CanvasRenderingContext2D, stage: Stage, theme: Theme): void {
    const { scan, projection, size } = stage;
    if (!scan) return;
    const words = `${toCount(this.#beyond)} beyond ${toShortMetres(projection.viewRange)}`;
    if (this.#beyond) drawBeyond(context, words, stage, theme);
    if (this.#domain) drawColorScale(context, size, this.#domain, colorScale(this.#domain, theme.dark), theme);
  }
}
