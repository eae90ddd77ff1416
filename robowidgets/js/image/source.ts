import { make } from "../shared/dom.ts";
import { fitScale, paintNumbers, type Scale, scaleColors } from "./colors.ts";
import { FILE, GRAY, isNumbers, type Picture, RGB, RGBA, sizeThere, toNumbers } from "./frame.ts";
import { type Statistics, statisticsOf } from "./region.ts";
import type { Known, Pixel } from "./text.ts";

/** The pixels of the picture on show, painted once for each frame, and what they say. */
export class Source {
  readonly canvas = make("canvas", "");
  readonly #context = this.canvas.getContext("2d", { willReadFrequently: true });
  /** What is painted; null before the first. */
  picture: Picture | null = null;
  /** Why the newest file could not be shown; empty: it could. */
  problem = "";
  scale: Scale = [0, 1];
  /** Share of the pixels with nothing. */
  nothing = 0;
  #numbers: Float32Array | Uint16Array | null = null;
  #decoding: Picture | null = null;
  #look = "";

  /**
   * Paints a picture. A file is unpacked first, and `onReady` called then; the picture before stays until that.
   * @returns whether it is painted now
   */
  paint(picture: Picture, fixed: Scale | null, dark: boolean, onReady: () => void): boolean {
    const look = JSON.stringify([fixed, dark]);
    if (picture === this.picture && (look === this.#look || !isNumbers(picture))) return true;
    if (picture.form === FILE) {
      if (picture !== this.#decoding) void this.#unpack(picture, onReady);
      return false;
    }
    this.#look = look;
    this.#decoding = null;
    this.#begin(picture);
    const { width, height } = this.canvas;
    const pixels = new ImageData(width, height);
    if (isNumbers(picture)) {
      const numbers = this.#numbers ?? toNumbers(picture);
      this.#numbers = numbers;
      this.scale = fixed ?? fitScale(numbers);
      const colors = scaleColors(picture.depthScale > 0, dark);
      const nothing = paintNumbers(new Uint32Array(pixels.data.buffer), numbers, this.scale, colors);
      this.nothing = nothing / numbers.length;
    } else spread(picture, pixels.data);
    this.#context?.putImageData(pixels, 0, 0);
    return true;
  }

  #begin(picture: Picture, size = sizeThere(picture)): void {
    if (picture !== this.picture) this.#numbers = null;
    this.picture = picture;
    this.problem = "";
    if (this.canvas.width !== size.width) this.canvas.width = size.width;
    if (this.canvas.height !== size.height) this.canvas.height = size.height;
  }

  async #unpack(picture: Picture, onReady: () => void): Promise<void> {
    this.#decoding = picture;
    try {
      const bitmap = await createImageBitmap(new Blob([picture.data]), {
        imageOrientation: "none",
        colorSpaceConversion: "none",
      });
      if (this.#decoding === picture) {
        this.#begin(picture, bitmap);
        this.#context?.clearRect(0, 0, bitmap.width, bitmap.height);
        this.#context?.drawImage(bitmap, 0, 0);
      }
      bitmap.close();
    } catch {
      if (this.#decoding === picture) this.problem = "This picture is damaged. Showing the last good one.";
    }
    onReady();
  }

  /** Whether a picture is being unpacked. */
  isBehind(picture: Picture): boolean {
    return picture !== this.picture && !this.problem;
  }

  /** The values of a pixel of the whole picture, or of the nearest one that is there. */
  valuesAt({ row, column }: Pixel): Known | null {
    const { picture } = this;
    if (!picture) return null;
    const [y, x] = [Math.floor(row / picture.every), Math.floor(column / picture.every)];
    const isExact = picture.isExact && row % picture.every === 0 && column % picture.every === 0;
    return { values: this.#read(picture, x, y, 1, 1).map((values) => values[0] ?? NaN), isExact };
  }

  /** What is in a part of the whole picture, of the pixels that are there. */
  statistics([top = 0, bottom = 0, left = 0, right = 0]: readonly number[]): Statistics | null {
    const { picture } = this;
    if (!picture) return null;
    const { every } = picture;
    const [y, x] = [Math.ceil(top / every), Math.ceil(left / every)];
    const size = sizeThere(picture);
    const width = Math.max(0, Math.min(size.width, Math.ceil(right / every)) - x);
    const height = Math.max(0, Math.min(size.height, Math.ceil(bottom / every)) - y);
    const channels = width && height ? this.#read(picture, x, y, width, height) : [];
    return statisticsOf(channels, picture.isExact && every === 1);
  }

  /** The values of some pixels that are there, channel by channel. */
  #read(picture: Picture, x: number, y: number, width: number, height: number): number[][] {
    const all = this.#numbers;
    if (all) {
      const columns = sizeThere(picture).width;
      const rows = Array.from({ length: height }, (_, i) => {
        const start = (y + i) * columns + x;
        return [...all.subarray(start, start + width)];
      });
      return [rows.flat()];
    }
    if (picture.form !== FILE) {
      const columns = sizeThere(picture).width;
      const count = picture.form === GRAY ? 1 : picture.form === RGB ? 3 : 4;
      return Array.from({ length: count }, (_, channel) =>
        Array.from({ length: width * height }, (_, i) => {
          const at = (y + Math.floor(i / width)) * columns + x + (i % width);
          return picture.data[at * count + channel] ?? NaN;
        }),
      );
    }
    const data = this.#context?.getImageData(x, y, width, height).data;
    return data
      ? [0, 1, 2].map((channel) => Array.from({ length: width * height }, (_, i) => data[4 * i + channel] as number))
      : [];
  }
}

/** Bytes of a picture as an ImageData has them. */
function spread({ form, data }: Picture, pixels: Uint8ClampedArray): void {
  if (form === RGBA) {
    pixels.set(data);
    return;
  }
  const whole = new Uint32Array(pixels.buffer);
  if (form === GRAY) {
    for (let i = 0; i < whole.length; i++) whole[i] = 0xff000000 | ((data[i] as number) * 0x010101);
    return;
  }
  for (let i = 0, at = 0; i < whole.length; i++, at += 3) {
    whole[i] = 0xff000000 | ((data[at + 2] as number) << 16) | ((data[at + 1] as number) << 8) | (data[at] as number);
  }
}
