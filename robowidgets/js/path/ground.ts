import { Reader, toBytes } from "../shared/bytes.ts";
import type { Place, Pose } from "../shared/floor.ts";
import type { Theme } from "../shared/theme.ts";
import {
  type Cells,
  cornersOf,
  inflate,
  type LayerAbout,
  type LayerState,
  type PackedGrid,
  toPackedGrids,
} from "./layers.ts";

/** Cells of all earlier grids that are kept for the history. */
const MOST_CELLS = 40e6;

/** The cells of a grid and their corner, in the frame of the map. */
export interface Grid {
  cells: Cells;
  corner: Pose;
}

interface Version {
  number: number;
  size: number;
  /** Null until they are inflated. */
  cells: Cells | null;
  ready: Promise<void>;
}

/** The large grids of a map, each of which is sent once, and the pictures of all grids. */
export class Ground {
  /** By their own numbers, in the order in which they came. */
  readonly #versions = new Map<number, Version>();
  /** The grid that each layer had on show last. */
  readonly #last = new Map<number, Grid>();
  readonly #pictures = new Map<number, { cells: Cells; key: string; picture: HTMLCanvasElement }>();
  readonly #corners = new WeakMap<Cells, { key: string; places: Place[] }>();

  /**
   * Takes the grids of a trait, and calls back when they are inflated. Earlier ones stay as long as a sample of the
   * history shows them, up to a number of cells.
   *
   * @param oldest the states of the layers in the oldest sample of the history.
   */
  async take(value: unknown, oldest: readonly LayerState[], callback: () => void): Promise<void> {
    const bytes = toBytes(value);
    const packed = bytes ? toPackedGrids(new Reader(bytes)) : [];
    for (const one of packed) if (!this.#versions.has(one.version)) this.#add(one);
    const present = new Set(packed.map(({ version }) => version));
    this.#forget(present, new Map(oldest.map(({ number, version }) => [number, version])));
    await Promise.all([...present].map((version) => this.#versions.get(version)?.ready));
    callback();
  }

  #add(packed: PackedGrid): void {
    const { number, version, rows, columns } = packed;
    const ready = inflate(packed).then((cells) => {
      added.cells = cells;
    });
    const added: Version = { number, size: rows * columns, cells: null, ready };
    this.#versions.set(version, added);
  }

  /** Drops unused grids, and the oldest used ones if the rest is too large. */
  #forget(present: ReadonlySet<number>, oldest: ReadonlyMap<number, number>): void {
    const earlier = [...this.#versions].filter(([version]) => !present.has(version));
    let size = earlier.reduce((sum, [, one]) => sum + one.size, 0);
    for (const [version, one] of earlier) {
      if (version >= (oldest.get(one.number) ?? 0) && size <= MOST_CELLS) continue;
      size -= one.size;
      this.#versions.delete(version);
    }
  }

  /** The grid of a state; until it is inflated, the previous one, or null. */
  gridOf(state: LayerState): Grid | null {
    const version = this.#versions.get(state.version);
    const cells = state.cells ?? version?.cells;
    if (!cells) return version ? (this.#last.get(state.number) ?? null) : null;
    const grid = { cells, corner: { x: state.x, y: state.y, yaw: state.yaw } };
    this.#last.set(state.number, grid);
    return grid;
  }

  /** Returns true if the grid of a state was dropped. */
  hasDropped({ number, version }: LayerState): boolean {
    if (this.#versions.has(version)) return false;
    return [...this.#versions].some(([later, one]) => later > version && one.number === number);
  }

  /** The corners of the known part of a grid, at its place in the map. */
  cornersOf(state: LayerState): Place[] {
    const grid = this.gridOf(state);
    if (!grid) return [];
    const { cells, corner } = grid;
    const key = `${corner.x} ${corner.y} ${corner.yaw}`;
    const known = this.#corners.get(cells);
    if (known?.key === key) return known.places;
    const places = cornersOf(cells, corner);
    this.#corners.set(cells, { key, places });
    return places;
  }

  /**
   * The picture of a layer's grid, a pixel for each cell, the last row on top; the last picture of each layer is kept.
   */
  pictureOf({ number, most = 100 }: LayerAbout, cells: Cells, isOver: boolean, theme: Theme): HTMLCanvasElement | null {
    const colors = isOver ? overColors(most, theme) : groundColors(most, theme);
    const key = [isOver, theme.seen, theme.muted, theme.guide].join();
    const known = this.#pictures.get(number);
    if (known?.cells === cells && known.key === key) return known.picture;
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
    this.#pictures.set(number, { cells, key, picture });
    return picture;
  }
}

type Rgb = readonly number[];

function toRgb(hex: string): Rgb {
  return [1, 3, 5].map((i) => Number.parseInt(hex.slice(i, i + 2), 16));
}

/** A pixel as canvases store it: alpha, blue, green and red, from the highest byte. */
function toPixelValue([red = 0, green = 0, blue = 0]: Rgb, alpha: number): number {
  return ((alpha << 24) | (blue << 16) | (green << 8) | red) >>> 0;
}

/** The colour of each byte: free as seen, occupied dark, in between mixed; the ground shows through unknown cells. */
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

/**
 * The colour of each byte of a costmap over the ground: two grays, for cells near something and for cells too close.
 */
function overColors(most: number, theme: Theme): Uint32Array {
  const gray = toRgb(theme.guide);
  const close = most > 127 ? 253 : 99;
  return Uint32Array.from({ length: 256 }, (_, byte) => {
    if (byte === 255 || byte === 0 || byte > most) return 0;
    return toPixelValue(gray, byte >= close ? 150 : 60);
  });
}
