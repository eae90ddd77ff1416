import { ticks } from "../shared/ticks.ts";
import { VIRIDIS } from "../shared/viridis.ts";

export type Scale = readonly [low: number, high: number];

/** Numbers that a scale is fitted to, at most. */
const SAMPLED = 4096;

/** Round numbers that hold all but the outermost hundredth of some numbers, so that one bad pixel moves nothing. */
export function fitScale(numbers: ArrayLike<number>): Scale {
  const step = Math.max(1, Math.floor(numbers.length / SAMPLED));
  const found: number[] = [];
  for (let i = 0; i < numbers.length; i += step) {
    const value = numbers[i] as number;
    if (Number.isFinite(value)) found.push(value);
  }
  if (!found.length) return [0, 1];
  found.sort((a, b) => a - b);
  const at = (part: number) => found[Math.round(part * (found.length - 1))] as number;
  return roundOut(at(0.01), at(0.99));
}

/** The smallest range between round numbers that holds two numbers. */
export function roundOut(low: number, high: number): Scale {
  if (!(high > low)) {
    const margin = Math.abs(low) / 10 || 1;
    return roundOut(low - margin, low + margin);
  }
  const [first = low, second = high] = ticks(low, high, 8);
  const step = second - first;
  const round = (value: number) => Number(value.toPrecision(12));
  return [round(Math.floor(low / step + 1e-9) * step), round(Math.ceil(high / step - 1e-9) * step)];
}

/** From low to high: viridis for distances, without the colors too dark for a dark page; grays for other numbers. */
export function scaleColors(isDepth: boolean, dark: boolean): string[] {
  if (isDepth) return dark ? VIRIDIS.slice(6) : VIRIDIS;
  return Array.from({ length: 256 }, (_, i) => `#${i.toString(16).padStart(2, "0").repeat(3)}`);
}

/** Paints numbers as pixels; invalid numbers stay clear. Returns the number of invalid ones. */
export function paintNumbers(pixels: Uint32Array, numbers: ArrayLike<number>, scale: Scale, colors: string[]): number {
  const palette = Uint32Array.from(colors, toPixel);
  const last = palette.length - 1;
  const [low, high] = scale;
  const factor = palette.length / (high - low || 1);
  let nothing = 0;
  for (let i = 0; i < numbers.length; i++) {
    const value = numbers[i] as number;
    if (Number.isNaN(value)) {
      pixels[i] = 0;
      nothing++;
    } else {
      const at = (value - low) * factor;
      pixels[i] = palette[at <= 0 ? 0 : at >= last ? last : at | 0] as number;
    }
  }
  return nothing;
}

/** "#rrggbb" as the number that a little-endian machine stores as red, green, blue, opaque. */
function toPixel(color: string): number {
  const [red = 0, green = 0, blue = 0] = [1, 3, 5].map((at) => Number.parseInt(color.slice(at, at + 2), 16));
  return ((255 << 24) | (blue << 16) | (green << 8) | red) >>> 0;
}
