import { type Box, holds, overlaps, type Point } from "../shared/box.ts";
import { toShortMetres } from "../shared/format.ts";
import { angleOf, type Scan, type Sweep } from "../shared/frames/scan.ts";
import { type Model, setTraits } from "../shared/model.ts";
import { rimBox } from "../shared/projection.ts";
import type { Stream } from "../shared/stream.ts";
import { type Theme, textFont } from "../shared/theme.ts";
import { angleFont, drawArea, drawGuides, drawRayLabels, drawRobot, indexFont } from "./draw_area.ts";
import { drawArcLabels } from "./draw_readings.ts";
import { type ArcLabel, arcDistances, arcLabels, type RayLabel, rayIndices, rayLabels, thinLabels } from "./guides.ts";
import type { Depth, Layer, Painter, Stage } from "./layer.ts";
import { shownBy } from "./mount.ts";
import type { LaserTraits } from "./traits.ts";

/** The detection area, range arcs, radial lines with their labels, and the robot. */
export class GuideLayer implements Layer {
  readonly traits = ["arc_count", "arc_distances", "ray_count", "ray_angles", "angle_unit", "own_angles"] as const;
  readonly #model: Model<LaserTraits>;
  readonly #stream: Stream<Scan>;
  readonly #measure: CanvasRenderingContext2D;
  readonly #painters: Partial<Record<Depth, Painter>> = {
    area: (context, { projection, sweep }, theme) => drawArea(context, projection, sweep, theme),
    guides: (context, stage, theme) => this.#drawGuides(context, stage, theme),
    // Names give way to the labels at the rim, and labels of arcs to names.
    edges: (_, { labels }) => labels.push(...this.#labelBoxes),
    words: (context, stage, theme) => this.#drawArcLabels(context, stage, theme),
  };
  #arcs: { distance: number; width: number }[] = [];
  #rays: number[] = [];
  #rayLabels: RayLabel[] = [];
  #shownLabels: RayLabel[] = [];
  #labelBoxes: Box[] = [];
  #arcLabels: ArcLabel[] = [];

  /** @param measure a context whose font may be set at any time */
  constructor(model: Model<LaserTraits>, stream: Stream<Scan>, measure: CanvasRenderingContext2D) {
    this.#model = model;
    this.#stream = stream;
    this.#measure = measure;
  }

  painters(): Partial<Record<Depth, Painter>> {
    return this.#painters;
  }

  lowerKey(): unknown {
    return [this.traits.map((name) => this.#model.get(name)), this.#stream.about.mount];
  }

  rim(sweep: Sweep, forward: number, theme: Theme): RayLabel[] {
    this.#rays = rayIndices(sweep, this.#model.get("ray_angles"), this.#model.get("ray_count"));
    const measure = ([angle, index]: [string, string]) =>
      Math.max(this.#widthOf(angle, angleFont(theme)), this.#widthOf(index, indexFont(theme)));
    const toShown = shownBy(this.#model, this.#stream.about);
    this.#rayLabels = rayLabels(sweep, this.#rays, forward, measure, this.#model.get("angle_unit"), toShown);
    return this.#rayLabels;
  }

  tip(point: Point): string {
    const label = this.#shownLabels.find((_, i) => holds(this.#labelBoxes[i] as Box, point));
    return label ? `${label.lines[1]} is the index of this ray in the array ranges, counted from 0.` : "";
  }

  onKey({ key }: KeyboardEvent): boolean {
    if (key !== "a" || !this.#stream.about.mount) return false;
    setTraits(this.#model, { own_angles: !this.#model.get("own_angles") });
    return true;
  }

  #drawGuides(context: CanvasRenderingContext2D, stage: Stage, theme: Theme): void {
    const { scan, projection, sweep, covered } = stage;
    const { count, minRange, maxRange } = sweep;
    this.#arcs = arcDistances(this.#model.get("arc_distances"), this.#model.get("arc_count"), projection.viewRange)
      .filter((distance) => count && distance > minRange && distance <= maxRange * (1 + 1e-6))
      .map((distance) => ({ distance, width: this.#widthOf(toShortMetres(distance), textFont(theme)) + 6 }));
    // Before the first scan the rays to number are unknown.
    const isFree = (label: RayLabel) => !covered.some((other) => overlaps(rimBox(projection, label), other));
    const thinned = scan ? thinLabels(projection, this.#rayLabels) : [];
    const kept = thinned.filter(isFree);
    // Includes labels that give way now: elements over the picture avoid these boxes.
    this.#shownLabels = thinned;
    this.#labelBoxes = thinned.map((label) => rimBox(projection, label));
    drawGuides(context, projection, sweep, this.#arcs, scan ? this.#rays : [], theme);
    drawRayLabels(context, projection, sweep, kept, theme);
    drawRobot(context, projection, theme);
  }

  #drawArcLabels(context: CanvasRenderingContext2D, stage: Stage, theme: Theme): void {
    const { scan, projection, sweep, occupied, labels, covered, edges } = stage;
    if (!scan) return;
    const lines = this.#rays.map((index) => angleOf(sweep, index));
    this.#arcLabels = arcLabels(projection, sweep, this.#arcs, lines, occupied, covered, this.#arcLabels, edges);
    labels.push(...this.#arcLabels.map(({ box }) => box));
    drawArcLabels(context, this.#arcLabels, theme);
  }

  #widthOf(text: string, font: string): number {
    this.#measure.font = font;
    return this.#measure.measureText(text).width;
  }
}
