import { viridisFor } from "../shared/viridis.ts";
import { type Cloud, type Column, columnOf, isColor } from "./cloud.ts";

export type Domain = [low: number, high: number];

/** A pixel as an ImageData has it in one number, little-endian: alpha, blue, green, red. */
function toPixelColor(color: string): number {
  const rgb = Number.parseInt(color.slice(1, 7), 16);
  return (0xff000000 | ((rgb & 0xff) << 16) | (rgb & 0xff00) | (rgb >> 16)) >>> 0;
}

/** A colour of a stylesheet, "#rrggbb" or "rgb(...)", as such a pixel. */
export function toPixel(color: string): number {
  if (color.startsWith("#") && color.length >= 7) return toPixelColor(color);
  const hex = color.startsWith("#")
    ? [...color.slice(1, 4)].map((digit) => digit + digit)
    : (color.match(/[\d.]+/g) ?? ["128", "128", "128"])
        .slice(0, 3)
        .map((part) => Math.round(Number(part)).toString(16).padStart(2, "0"));
  return toPixelColor(`#${hex.join("")}`);
}

/** Such a pixel through which most of the ground is seen. */
export function faint(pixel: number): number {
  return ((pixel & 0xffffff) | 0x60000000) >>> 0;
}

/** Least and greatest value of the points. It widens at once, and narrows only when it is far too wide. */
export function domainOf(cloud: Cloud, name: string, before: Domain | null): Domain | null {
  const values = columnOf(cloud, name);
  if (!values) return null;
  let [low, high] = [Infinity, -Infinity];
  for (let i = 0; i < cloud.count; i++) {
    const value = values[i] as number;
    if (!Number.isFinite(value) || Number.isNaN(cloud.distance[i])) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (low > high) return null;
  if (!before) return [low, high];
  const widened: Domain = [Math.min(low, before[0]), Math.max(high, before[1])];
  return widened[1] - widened[0] > 2 * (high - low) ? [low, high] : widened;
}

/** The coloring of the points. */
export interface Coloring {
  /** The name of the field, or "" for one colour. */
  by: string;
  /** Null for one colour, and if the field itself holds colours. */
  domain: Domain | null;
  /** The pixel of each point. */
  pixels: Uint32Array;
}

/** Steps of a legend from its lower to its upper end. */
export function stepsOf(dark: boolean): string[] {
  return viridisFor(dark);
}

/**
 * The colours of all points.
 *
 * @param plain for points in one colour
 * @param unknown of points without a value
 */
export function colorsOf(
  cloud: Cloud,
  by: string,
  range: Domain | null,
  dark: boolean,
  plain: number,
  unknown: number,
): Coloring {
  const pixels = new Uint32Array(cloud.count);
  const values = columnOf(cloud, by);
  if (values && isColor(by)) return { by, domain: null, pixels: fromBytes(values, cloud.count) };
  if (!values || !range) return { by: "", domain: null, pixels: pixels.fill(plain) };
  const steps = stepsOf(dark).map(toPixelColor);
  const [low, high] = range;
  const perValue = steps.length / (high - low || 1);
  for (let i = 0; i < cloud.count; i++) {
    const value = values[i] as number;
    const step = Math.floor((value - low) * perValue);
    pixels[i] = Number.isNaN(value) ? unknown : (steps[Math.min(steps.length - 1, Math.max(0, step))] as number);
  }
  return { by, domain: range, pixels };
}

/** Red, green and blue lie in three bytes of each number, whatever its type. */
function fromBytes(values: Column, count: number): Uint32Array {
  const words = new Uint32Array(values.buffer, values.byteOffset, count * (values.BYTES_PER_ELEMENT === 4 ? 1 : 0));
  return Uint32Array.from({ length: count }, (_, i) => {
    const word = words[i] ?? 0;
    return (0xff000000 | ((word & 0xff) << 16) | (word & 0xff00) | ((word >> 16) & 0xff)) >>> 0;
  });
}
