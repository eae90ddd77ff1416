import { make } from "../shared/dom.ts";
import { fitScale, paintNumbers, type Scale, scaleColors } from "./colors.ts";
import { FILE, GRAY, isNumbers, type Picture, RGBA, sizeThere, toNumbers } from "./frame.ts";
import { type Statistics, statisticsOf } from "./region.ts";
import type { Known, Pixel } from "./text.ts";
import type { ImageAbout } from "./traits.ts";

/** The pixels of the picture on show, painted once for each frame, and their values. */
export class Source {
  readonly canvas = make("canvas", "");
  readonly #context = this.canvas.getContext("2d", { willReadFrequently: true });
  /** The painted picture; null before the first. */
  picture: Picture | null = null;
  /** The reason why the newest file could not be shown, or "" if it could. */
  problem = "";
  scale: Scale = [0, 1];
  /** Share of the pixels without a value. */
  nothing = 0;
  #numbers: Float32Array | Uint16Array | null = null;
  #decoding: Picture | null = null;
  #damaged: Picture | null = null;
  /** The pixels that were painted last, to be painted over. */
  #painted: ImageData | null = null;
  #look = "";
  /** The last statistics of a part, which pointing asks for again. */
  #found: { picture: Picture; key: string; statistics: Statistics } | null = null;

  /**
   * Paints a picture. A file is unpacked first, and then `onReady` is called; until then, the previous picture stays.
   * @returns true if it is painted now
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
    const before = this.#painted;
    const pixels = before?.width === width && before.height === height ? before : new ImageData(width, height);
    this.#painted = pixels;
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
      if (this.#decoding === picture) {
        this.#damaged = picture;
        this.problem = "This picture is damaged. Showing the last good one.";
      }
    }
    onReady();
  }

  /** Returns true while a picture is being unpacked. */
  isBehind(picture: Picture): boolean {
    return picture !== this.picture && picture !== this.#damaged;
  }

  /** The values of a pixel of the whole picture, or of the nearest pixel that the page has. */
  valuesAt({ row, column }: Pixel, about: ImageAbout): Known | null {
    const { picture } = this;
    if (!picture) return null;
    const [y, x] = [Math.floor(row / picture.every), Math.floor(column / picture.every)];
    const isExact = picture.isExact && row % picture.every === 0 && column % picture.every === 0;
    const values = this.#read(picture, x, y, 1, 1).map((values) => values[0] ?? NaN);
    return { values: inChannels(values, about), isExact, isShown: about.recolored === true };
  }

  /** The statistics of a part of the whole picture, from the pixels that the page has. */
  statistics(region: readonly number[], about: ImageAbout): Statistics | null {
    const { picture } = this;
    if (!picture) return null;
    const key = region.join();
    if (this.#found?.picture === picture && this.#found.key === key) return this.#found.statistics;
    const { every } = picture;
    const [top = 0, bottom = 0, left = 0, right = 0] = region;
    const [y, x] = [Math.ceil(top / every), Math.ceil(left / every)];
    const size = sizeThere(picture);
    const width = Math.max(0, Math.min(size.width, Math.ceil(right / every)) - x);
    const height = Math.max(0, Math.min(size.height, Math.ceil(bottom / every)) - y);
    const channels = width && height ? this.#read(picture, x, y, width, height) : [];
    const isExact = picture.isExact && every === 1;
    const statistics = { ...statisticsOf(inChannels(channels, about), isExact), isShown: about.recolored === true };
    this.#found = { picture, key, statistics };
    return statistics;
  }

  /** The values of some pixels that the page has, channel by channel. */
  #read(picture: Picture, x: number, y: number, width: number, height: number): Float64Array[] {
    const { form, data } = picture;
    const columns = sizeThere(picture).width;
    const start = y * columns + x;
    if (this.#numbers) return [cut(this.#numbers, start, columns, width, height, 0, 1)];
    const count = form === GRAY ? 1 : form === RGBA ? 4 : 3;
    const channels = Array.from({ length: count }, (_, channel) => channel);
    if (form !== FILE) return channels.map((one) => cut(data, start, columns, width, height, one, count));
    const pixels = this.#context?.getImageData(x, y, width, height).data;
    return pixels ? channels.map((one) => cut(pixels, 0, width, width, height, one, 4)) : [];
  }
}

/**
 * Red, green and blue of the page in the order of the channels of the message. For a picture with one channel that came
 * as a JPEG, each of them is that channel.
 */
function inChannels<T>(shown: T[], { channels = "", recolored }: ImageAbout): T[] {
  if (recolored || shown.length === 1) return shown;
  return [...(channels || "r")].flatMap((letter) => shown["rgba".indexOf(letter)] ?? []);
}

/** Cuts one channel of a part of a picture out of its pixels, row by row, from the pixel of a number on. */
function cut(
  values: ArrayLike<number>,
  start: number,
  columns: number,
  width: number,
  height: number,
  channel: number,
  count: number,
): Float64Array {
  const found = new Float64Array(width * height);
  for (let row = 0, at = 0; row < height; row++) {
    const from = start + row * columns;
    for (let i = from; i < from + width; i++) found[at++] = values[i * count + channel] as number;
  }
  return found;
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
