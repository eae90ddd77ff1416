import { angleOf } from "../shared/frames/scan.ts";
import type { Model } from "../shared/model.ts";
import { drawName, fillWedge, rimOf, strokeArc } from "./draw_sector.ts";
import type { Depth, Layer, Painter, Stage, StripPainter } from "./layer.ts";
import { type Sector, stretchesOf } from "./sector.ts";
import { fillStretch } from "./strip_sector.ts";
import type { LaserTraits } from "./traits.ts";

/** Of the fill of the rays. */
const OPACITY = 0.11;

/** Rays that a program has highlighted. */
export class HighlightLayer implements Layer {
  readonly traits = ["_highlight"] as const;
  readonly #model: Model<LaserTraits>;

  constructor(model: Model<LaserTraits>) {
    this.#model = model;
  }

  painters(): Partial<Record<Depth, Painter>> {
    const { text = "", stretches, sector } = this.#model.get("_highlight");
    if (!stretches && !sector) return {};
    return {
      fills: (context, stage, theme) => {
        for (const wedge of this.#wedges(stage)) {
          fillWedge(context, stage.projection, wedge, rimOf(stage), theme.pointer, OPACITY);
        }
      },
      edges: (context, stage, theme) => {
        for (const wedge of this.#wedges(stage)) {
          strokeArc(context, stage.projection, wedge, rimOf(stage), theme.pointer, 3.5);
        }
      },
      names: (context, stage, theme) => {
        const [widest] = this.#wedges(stage).sort((a, b) => b.end - b.start - (a.end - a.start));
        const place = widest && text ? drawName(context, stage, widest, [text], theme.pointer, theme) : null;
        if (place) stage.covered.push(place.box);
      },
    };
  }

  strip(): Partial<Record<Depth, StripPainter>> {
    const { stretches, sector } = this.#model.get("_highlight");
    if (!stretches && !sector) return {};
    return {
      fills: (context, strip, theme) => {
        const found = sector && strip.scan ? stretchesOf(strip.scan, sector) : (stretches ?? []);
        const fill = { color: theme.pointer, opacity: OPACITY };
        for (const stretch of found) fillStretch(context, strip, stretch, fill);
      },
    };
  }

  lowerKey(): unknown {
    return this.#model.get("_highlight");
  }

  /** Half a step is added on both sides, so that a single ray is seen. */
  #wedges({ sweep }: Stage): Sector[] {
    const { stretches, sector } = this.#model.get("_highlight");
    if (sector) return [sector];
    const half = Math.abs(sweep.angleIncrement) / 2;
    return (stretches ?? [])
      .filter(([start]) => start < sweep.count)
      .map(([start, stop]) => {
        const ends = [angleOf(sweep, start), angleOf(sweep, Math.min(stop, sweep.count) - 1)];
        return { start: Math.min(...ends) - half, end: Math.max(...ends) + half };
      });
  }
}
