import type { Box } from "../shared/box.ts";
import { Canvas, type Surface } from "../shared/canvas.ts";
import type { Scan } from "../shared/frames/scan.ts";
import type { Model } from "../shared/model.ts";
import { Occupancy } from "../shared/occupancy.ts";
import { FORWARD, fit, sweepRim } from "../shared/projection.ts";
import type { Theme } from "../shared/theme.ts";
import { type Depth, type Layer, LOWER, type Painter, type Stage, UPPER } from "./layer.ts";
import type { LaserTraits } from "./traits.ts";
import { fitsReadings, resolveRange } from "./zoom.ts";

/** The sweep of an empty widget: a common scanner. */
const PLACEHOLDER = {
  angleMin: (-3 * Math.PI) / 4,
  angleIncrement: Math.PI / 180,
  count: 271,
  minRange: 0.1,
  maxRange: 10,
};

/** The traits on which the geometry of the picture depends. */
export const SETTINGS = ["view_range", "forward"] as const;

/**
 * The two canvases of one view, on which the layers paint: the lower one for parts that change seldom, the upper one
 * for parts that change with each scan.
 */
export class Scene {
  stage: Stage;
  readonly #model: Model<LaserTraits>;
  readonly #lower: Canvas;
  readonly #upper: Canvas;
  #lowerKey = "";
  #fitted = 0;

  constructor(model: Model<LaserTraits>, parent: HTMLElement) {
    this.#model = model;
    this.#lower = new Canvas(parent);
    this.#upper = new Canvas(parent);
    this.stage = {
      scan: null,
      sweep: PLACEHOLDER,
      projection: { centerX: 0, centerY: 0, radius: 1, viewRange: 1, forward: 0 },
      size: { width: 0, height: 0, ratio: 1 },
      box: { x: 0, y: 0, width: 0, height: 0 },
      occupied: new Occupancy(1, 1),
      labels: [],
      covered: [],
      edges: [],
    };
  }

  /** A context for measuring text: its font may be set at any time. */
  get measure(): CanvasRenderingContext2D {
    return this.#lower.context;
  }

  /**
   * @param layers in order from the ground
   * @param insetTop room at the top that a notice takes, in pixels
   * @param covered parts of the picture that something covers
   */
  draw(layers: Layer[], scan: Scan | null, size: Surface, insetTop: number, covered: Box[], theme: Theme): void {
    const insetBottom = layers.reduce((sum, layer) => sum + (layer.roomBelow?.(scan) ?? 0), 0);
    const box = { x: 0, y: insetTop, width: size.width, height: Math.max(40, size.height - insetTop - insetBottom) };
    const { angleMin, angleIncrement, count, minRange, maxRange } = scan ?? PLACEHOLDER;
    const sweep = { angleMin, angleIncrement, count, minRange, maxRange };
    const range = this.#model.get("view_range");
    const viewRange = resolveRange(range, scan, this.#fitted);
    this.#fitted = fitsReadings(range, scan?.maxRange) ? viewRange : 0;
    const forward = FORWARD[this.#model.get("forward")] ?? 0;

    const taken = [...covered, ...layers.flatMap((layer) => layer.covers?.() ?? [])];
    const keys = layers.map((layer) => layer.lowerKey?.());
    const key = JSON.stringify([Boolean(scan), sweep, viewRange, forward, box, size, theme, taken, keys]);
    const isSame = key === this.#lowerKey;
    let { projection } = this.stage;
    if (!isSame) {
      const labels = scan ? layers.flatMap((one) => one.rim?.(sweep, forward, theme) ?? []) : [];
      // A scan without rays leaves the scanner where the next one will show it.
      const rim = [...sweepRim(count ? sweep : PLACEHOLDER, forward), ...labels];
      projection = { ...fit(rim, box), viewRange, forward };
      this.#lowerKey = key;
    }
    const occupied = new Occupancy(size.width, size.height);
    this.stage = { scan, sweep, projection, size, box, occupied, labels: [], covered: taken, edges: [] };

    const painters = layers.map((layer) => layer.painters());
    if (!isSame) this.#paint(this.#lower.begin(size), LOWER, painters, theme);
    this.#paint(this.#upper.begin(size), UPPER, painters, theme);
  }

  #paint(
    context: CanvasRenderingContext2D,
    depths: readonly Depth[],
    painters: Partial<Record<Depth, Painter>>[],
    theme: Theme,
  ): void {
    for (const depth of depths) for (const paint of painters) paint[depth]?.(context, this.stage, theme);
  }
}
