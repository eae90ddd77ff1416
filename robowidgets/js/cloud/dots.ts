import type { Box, Point } from "../shared/box.ts";
import type { Context, Surface } from "../shared/canvas.ts";
import { type Cloud, drawnColumns } from "./cloud.ts";
import { columnsOf, type Projection } from "./projection.ts";

/** Pixels around a pointer in which a point is found. */
const REACH = 7;

/**
 * Points as dots in the bytes of a picture, the nearest to the viewer on top, and the point that is seen at each pixel.
 */
export class Dots {
  #width = 0;
  #height = 0;
  #ratio = 1;
  #pixels = new Uint32Array();
  #points = new Int32Array();
  #depths = new Float32Array();
  #image: ImageData | null = null;

  /** Clears them for a picture of this size. */
  begin({ width, height, ratio }: Surface): void {
    const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
    this.#ratio = ratio;
    if (w !== this.#width || h !== this.#height) {
      [this.#width, this.#height] = [w, h];
      this.#image = new ImageData(Math.max(1, w), Math.max(1, h));
      this.#pixels = new Uint32Array(this.#image.data.buffer);
      this.#points = new Int32Array(this.#pixels.length);
      this.#depths = new Float32Array(this.#pixels.length);
    } else {
      this.#pixels.fill(0);
    }
    this.#points.fill(-1);
    this.#depths.fill(-Infinity);
  }

  /**
   * Draws points to scale.
   *
   * @param colors a pixel for each point
   * @param behind 1 for each point that lies under all others, such as the unselected points; null without such points
   */
  place(cloud: Cloud, projection: Projection, colors: Uint32Array, behind: Uint8Array | null): void {
    const { axes, box, look, scale } = projection;
    const ratio = this.#ratio;
    const [rights, ups, nears] = columnsOf(cloud, axes);
    const [perRight, perUp] = [scale * ratio * axes.right.sign, scale * ratio * axes.up.sign];
    const centerX = (box.x + box.width / 2 - look.right * scale) * ratio;
    const centerY = (box.y + box.height / 2 + look.up * scale) * ratio;
    const [left, top] = [Math.round(box.x * ratio), Math.round(box.y * ratio)];
    const [right, bottom] = [Math.round((box.x + box.width) * ratio), Math.round((box.y + box.height) * ratio)];
    const size = Math.max(1, Math.round(dotSize(cloud.count) * ratio));
    const half = (size - 1) / 2;
    const { distance, count } = cloud;
    const wide = this.#width;
    for (let i = 0; i < count; i++) {
      // Comparisons with NaN are false.
      if (!((distance[i] as number) >= 0)) continue;
      const x = Math.round(centerX + (rights[i] as number) * perRight - half);
      const y = Math.round(centerY - (ups[i] as number) * perUp - half);
      if (x < left || y < top || x + size > right || y + size > bottom) continue;
      const depth = axes.near.sign * (nears[i] as number) - (behind && !behind[i] ? 1e9 : 0);
      const color = colors[i] as number;
      for (let row = 0; row < size; row++) {
        for (let at = (y + row) * wide + x, end = at + size; at < end; at++) {
          if (depth < (this.#depths[at] as number)) continue;
          this.#depths[at] = depth;
          this.#pixels[at] = color;
          this.#points[at] = i;
        }
      }
    }
  }

  /** Draws points as they lie in rows, each as a cell; cells without a point stay clear. */
  placeRows(cloud: Cloud, box: Box, colors: Uint32Array): void {
    const ratio = this.#ratio;
    const [left, top] = [Math.round(box.x * ratio), Math.round(box.y * ratio)];
    const [wide, high] = [Math.round(box.width * ratio), Math.round(box.height * ratio)];
    const columns = drawnColumns(cloud);
    const rows = columns ? cloud.count / columns : 0;
    for (let y = 0; y < high; y++) {
      const first = Math.floor((y / high) * rows) * columns;
      const start = (top + y) * this.#width + left;
      for (let x = 0; x < wide; x++) {
        const i = first + Math.floor((x / wide) * columns);
        if (!((cloud.distance[i] as number) >= 0)) continue;
        this.#pixels[start + x] = colors[i] as number;
        this.#points[start + x] = i;
      }
    }
  }

  paint(context: Context): void {
    if (this.#image) context.putImageData(this.#image, 0, 0);
  }

  /** The point seen at a place, or the nearest one within reach; -1 if there is none. */
  at({ x, y }: Point, reach = REACH): number {
    const ratio = this.#ratio;
    const [px, py, far] = [Math.floor(x * ratio), Math.floor(y * ratio), Math.ceil(reach * ratio)];
    let [found, least] = [-1, far * far + 1];
    for (let row = Math.max(0, py - far); row <= Math.min(this.#height - 1, py + far); row++) {
      for (let column = Math.max(0, px - far); column <= Math.min(this.#width - 1, px + far); column++) {
        const point = this.#points[row * this.#width + column] as number;
        const away = (row - py) ** 2 + (column - px) ** 2;
        if (point >= 0 && away < least) [found, least] = [point, away];
      }
    }
    return found;
  }
}

/** Pixels of the side of a dot: fewer points are drawn larger. */
export function dotSize(count: number): number {
  if (count < 500) return 4;
  if (count < 5000) return 3;
  return count < 30_000 ? 2 : 1.5;
}
