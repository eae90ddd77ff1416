import { NO_MEASUREMENT, NOTHING_IN_RANGE, OUTSIDE_LIMITS, TOO_CLOSE, type Validity } from "../shared/frames/scan.ts";
import type { Theme } from "../shared/theme.ts";
import { VIRIDIS } from "../shared/viridis.ts";
import { CLOSEST, FARTHEST, KINDS, NO_SCAN, type Sweep, toRange } from "./data.ts";

/** The colour of each class without a distance. */
export function classColors(theme: Theme): Partial<Record<Validity, string>> {
  const grays = theme.dark ? ["#262d34", "#6b7785", "#a9b4c0"] : ["#eef1f4", "#b9c2cc", "#7d8997"];
  const [nothing = "", outside = "", none = ""] = grays;
  return {
    [NOTHING_IN_RANGE]: nothing,
    [OUTSIDE_LIMITS]: outside,
    [NO_MEASUREMENT]: none,
    [TOO_CLOSE]: theme.reading,
  };
}

/** From near to far, without the colours that are too dark for a dark page. */
export function distanceColors(dark: boolean): string[] {
  return dark ? VIRIDIS.slice(6) : VIRIDIS;
}

/** The colour of every code, as an ImageData holds it. */
export function toPalette(theme: Theme, sweep: Sweep, [near, far]: [number, number]): Uint32Array {
  const palette = new Uint32Array(65_536);
  const colors = distanceColors(theme.dark).map(toPixel);
  for (let code = CLOSEST; code <= FARTHEST; code++) {
    const part = (toRange(code, sweep) - near) / (far - near || 1);
    palette[code] = colors[Math.min(colors.length - 1, Math.max(0, Math.floor(part * colors.length)))] ?? 0;
  }
  const classes = classColors(theme);
  for (const [code, kind] of Object.entries(KINDS)) palette[Number(code)] = toPixel(classes[kind] ?? "");
  palette[NO_SCAN] = 0;
  return palette;
}

/** "#rrggbb" as the number that a little-endian machine stores as red, green, blue, opaque. */
function toPixel(color: string): number {
  const [red, green, blue] = [1, 3, 5].map((at) => Number.parseInt(color.slice(at, at + 2), 16));
  return ((255 << 24) | ((blue ?? 0) << 16) | ((green ?? 0) << 8) | (red ?? 0)) >>> 0;
}
