import { Layer, type Surface } from "../shared/canvas.ts";
import { toCount, toShortMetres } from "../shared/format.ts";
import type { Model } from "../shared/model.ts";
import type { Theme } from "../shared/theme.ts";
import { colorScale, type Domain, drawColorScale, intensityDomain, SCALE_HEIGHT } from "./color.ts";
import {
  angleFont,
  arcFont,
  drawArea,
  drawGuides,
  drawLine,
  drawRayLabels,
  drawRobot,
  indexFont,
} from "./draw_area.ts";
import { drawArcLabels, drawBeyond, drawReadings } from "./draw_readings.ts";
import {
  type ArcLabel,
  arcDistances,
  arcLabels,
  Occupancy,
  type RayLabel,
  rayIndices,
  rayLabels,
  thinLabels,
} from "./guides.ts";
import { type Box, FORWARD, fit, type Point, type Projection, rimBox, sweepRim, toPixel } from "./projection.ts";
import { angleOf, OUTSIDE_LIMITS, READING, type Scan } from "./scan.ts";
import { CLASSES } from "./text.ts";
import type { LaserTraits } from "./traits.ts";
import { fitsReadings, resolveRange } from "./zoom.ts";

/** What an empty widget shows: the area of a common scanner. */
const PLACEHOLDER = {
  angleMin: (-3 * Math.PI) / 4,
  angleIncrement: Math.PI / 180,
  count: 271,
  minRange: 0.1,
  maxRange: 10,
};

/** The traits on which the lower canvas depends. */
export const SETTINGS = ["view_range", "arc_count", "ray_count", "arc_distances", "forward"] as const;

/** The two canvases of one view: beneath, what changes seldom; above, the readings. */
export class Scene {
  projection: Projection = { centerX: 0, centerY: 0, radius: 1, viewRange: 1, forward: 0 };
  occupied = new Occupancy(1, 1);
  box: Box = { x: 0, y: 0, width: 0, height: 0 };
  /** Where the labels of the rays stand. */
  labelBoxes: Box[] = [];
  readonly #model: Model<LaserTraits>;
  readonly #base: Layer;
  readonly #top: Layer;
  #baseKey = "";
  #fitted = 0;
  #domain: Domain | null = null;
  #arcs: { distance: number; width: number }[] = [];
  #rays: number[] = [];
  #arcLabels: ArcLabel[] = [];

  constructor(model: Model<LaserTraits>, parent: HTMLElement) {
    this.#model = model;
    this.#base = new Layer(parent);
    this.#top = new Layer(parent);
  }

  /** The metres the view reaches now. */
  get viewRange(): number {
    return this.projection.viewRange;
  }

  /**
   * @param insetTop room at the top that a notice takes, in pixels
   * @param covered parts of the picture that something covers
   */
  draw(scan: Scan | null, size: Surface, insetTop: number, covered: Box[], theme: Theme): void {
    const colored = scan?.intensities.length && this.#model.get("color_by_intensity");
    this.#domain = scan && colored ? intensityDomain(scan, this.#domain) : null;
    const insetBottom = this.#domain ? SCALE_HEIGHT : 0;
    this.box = { x: 0, y: insetTop, width: size.width, height: Math.max(40, size.height - insetTop - insetBottom) };
    this.#drawBase(scan, size, theme);
    const context = this.#top.begin(size);
    this.occupied = new Occupancy(size.width, size.height);
    if (scan) {
      const colorOf = this.#domain ? colorScale(this.#domain, theme.dark) : null;
      const shown = new Set(this.#model.get("marks"));
      const marks = new Set(CLASSES.filter(({ name }) => shown.has(name)).map(({ kind }) => kind));
      const style = { theme, marks, colorOf };
      const beyond = drawReadings(context, this.projection, scan, style, this.occupied);
      if (beyond) drawBeyond(context, `${toCount(beyond)} beyond ${toShortMetres(this.viewRange)}`, this, theme);
      if (this.#domain && colorOf) drawColorScale(context, size, this.#domain, colorOf, theme);
    }
    const sweep = scan ?? PLACEHOLDER;
    const lines = this.#rays.map((index) => angleOf(sweep, index));
    this.#arcLabels = arcLabels(this.projection, sweep, this.#arcs, lines, this.occupied, covered, this.#arcLabels);
    drawArcLabels(context, this.#arcLabels, theme);
  }

  /** Draws the ray that a pop-up names, to its reading or the edge of the view; returns its end in the picture. */
  drawPointer(scan: Scan, index: number, theme: Theme): Point {
    const { context } = this.#top;
    const kind = scan.kinds[index];
    const isMeasured = kind === READING || kind === OUTSIDE_LIMITS;
    const seen = Math.min(isMeasured ? Math.max(0, scan.ranges[index] as number) : scan.maxRange, this.viewRange);
    const angle = angleOf(scan, index);
    const end = toPixel(this.projection, seen, angle);
    context.setLineDash(kind === READING ? [] : [4, 4]);
    drawLine(context, this.projection, angle, 0, seen, theme.pointer, 1.5);
    context.setLineDash([]);
    context.beginPath();
    context.arc(end.x, end.y, 6, 0, 2 * Math.PI);
    context.lineWidth = 2;
    context.stroke();
    drawRobot(context, this.projection, theme);
    return end;
  }

  #drawBase(scan: Scan | null, size: Surface, theme: Theme): void {
    const [range, forward] = [this.#model.get("view_range"), this.#model.get("forward")];
    const settings = SETTINGS.map((name) => this.#model.get(name));
    const { angleMin, angleIncrement, count, minRange, maxRange } = scan ?? PLACEHOLDER;
    const sweep = { angleMin, angleIncrement, count, minRange, maxRange };
    const viewRange = resolveRange(range, scan, this.#fitted);
    this.#fitted = fitsReadings(range, scan?.maxRange) ? viewRange : 0;
    const key = JSON.stringify([sweep, viewRange, settings, this.box, size, theme]);
    if (key === this.#baseKey) return;
    this.#baseKey = key;

    const context = this.#base.begin(size);
    const turn = FORWARD[forward] ?? 0;
    this.#rays = rayIndices(sweep, this.#model.get("ray_count"));
    const labels = rayLabels(sweep, this.#rays, turn, (lines) => measure(context, theme, lines));
    const rim = [...sweepRim(sweep, turn), ...labels];
    this.projection = { ...fit(rim, this.box), viewRange, forward: turn };
    context.font = arcFont(theme);
    this.#arcs = arcDistances(this.#model.get("arc_distances"), this.#model.get("arc_count"), viewRange)
      .filter((distance) => count && distance > minRange && distance <= maxRange * (1 + 1e-6))
      .map((distance) => ({ distance, width: context.measureText(toShortMetres(distance)).width + 6 }));
    const kept: RayLabel[] = thinLabels(this.projection, labels);
    this.labelBoxes = kept.map((label) => rimBox(this.projection, label));
    drawArea(context, this.projection, sweep, theme);
    drawGuides(context, this.projection, sweep, this.#arcs, this.#rays, theme);
    drawRayLabels(context, this.projection, kept, theme);
    drawRobot(context, this.projection, theme);
  }
}

function measure(context: CanvasRenderingContext2D, theme: Theme, [angle, index]: [string, string]): number {
  context.font = angleFont(theme);
  const above = context.measureText(angle).width;
  context.font = indexFont(theme);
  return Math.max(above, context.measureText(index).width);
}
