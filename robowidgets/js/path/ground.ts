import { Reader, toBytes } from "../shared/bytes.ts";
import type { Place } from "../shared/floor.ts";
import type { Theme } from "../shared/theme.ts";
import { type Cells, cornersOf, inflate, type LayerState, toPackedGrids } from "./layers.ts";

interface Version {
  time: number;
  cells: Cells;
}

/** The large grids of a map, which come once, and the pictures of all grids. */
export class Ground {
  #versions = new Map<number, Version[]>();
  #pictures = new WeakMap<Cells, { key: string; picture: HTMLCanvasElement }>();
  #corners = new WeakMap<Cells, { key: string; places: Place[] }>();
  #edition = 0;

  /** Takes the grids of a trait, and calls back when they are inflated; those before stay until then. */
  async take(value: unknown, callback: () => void): Promise<void> {
    this.#edition++;
    const edition = this.#edition;
    const bytes = toBytes(value);
    const packed = bytes ? toPackedGrids(new Reader(bytes)) : [];
    const cells = await Promise.all(packed.map(inflate));
    if (edition !== this.#edition) return;
    this.#versions = new Map();
    for (const [i, { number, time }] of packed.entries()) {
      const own = this.#versions.get(number) ?? [];
      own.push({ time, cells: cells[i] as Cells });
      this.#versions.set(number, own);
    }
    callback();
  }

  /** The cells of a grid at the time of its state; null while they are not there. */
  cellsOf({ number, time, cells }: LayerState): Cells | null {
    if (cells) return cells;
    const own = this.#versions.get(number) ?? [];
    return (own.filter((version) => version.time <= time + 1e-6).at(-1) ?? own[0])?.cells ?? null;
  }

  /** The corners of what a grid knows, where it lies in the map. */
  cornersOf(state: LayerState): Place[] {
    const cells = this.cellsOf(state);
    if (!cells) return [];
    const key = `${state.x} ${state.y} ${state.yaw}`;
    const known = this.#corners.get(cells);
    if (known?.key === key) return known.places;
    const places = cornersOf(cells, state);
    this.#corners.set(cells, { key, places });
    return places;
  }

  /** The picture of a grid, a pixel for each cell, the last row on top. */
  pictureOf(cells: Cells, most: number, isOver: boolean, theme: Theme): HTMLCanvasElement | null {
    const colors = isOver ? overColors(most, theme) : groundColors(most, theme);
    const key = [isOver, theme.seen, theme.muted, theme.guide].join();
    const known = this.#pictures.get(cells);
    if (known?.key === key) return known.picture;
    const { rows, columns, data } = cells;
    const picture = document.createElement("canvas");
    [picture.width, picture.height] = [columns, rows];
    const context = picture.getContext("2d");
    if (!context) return null;
    const image = context.createImageData(columns, rows);
    const pixels = new Uint32Array(image.data.buffer);
    for (let row = 0; row < rows; row++) {
      const [from, to] = [row * columns, (rows - 1 - row) * columns];
      for (let column = 0; column < columns; column++)
        pixels[to + column] = colors[data[from + column] as number] as number;
    }
    context.putImageData(image, 0, 0);
    this.#pictures.set(cells, { key, picture });
    return picture;
  }
}

type Rgb = readonly number[];

function toRgb(hex: string): Rgb {
  return [1, 3, 5].map((i) => Number.parseInt(hex.slice(i, i + 2), 16));
}

/** A pixel as canvases keep it: alpha, blue, green and red, from the highest byte. */
function toPixelValue([red = 0, green = 0, blue = 0]: Rgb, alpha: number): number {
  return ((alpha << 24) | (blue << 16) | (green << 8) | red) >>> 0;
}

/** The colour of each byte: free as seen, occupied dark, in between mixed; the ground shows through what is unknown. */
function groundColors(most: number, theme: Theme): Uint32Array {
  const [free, full] = [toRgb(theme.seen), toRgb(theme.muted)];
  return Uint32Array.from({ length: 256 }, (_, byte) => {
    if (byte === 255 || byte > most) return 0;
    const share = byte / most;
    return toPixelValue(
      free.map((low, i) => Math.round(low + share * ((full[i] ?? low) - low))),
      255,
    );
  });
}

/** The colour of each byte of a costmap over the ground: two grays, of what is near something and what is too close. */
function overColors(most: number, theme: Theme): Uint32Array {
  const gray = toRgb(theme.guide);
  const close = most > 127 ? 253 : 99;
  return Uint32Array.from({ length: 256 }, (_, byte) => {
    if (byte === 255 || byte === 0 || byte > most) return 0;
    return toPixelValue(gray, byte >= close ? 150 : 60);
  });
}
