import { write } from "../shared/canvas.ts";
import { toFixed } from "../shared/format.ts";
import { READING, type Scan } from "../shared/frames/scan.ts";
import { type Theme, textFont } from "../shared/theme.ts";
import { viridisFor } from "../shared/viridis.ts";

export type Domain = [number, number];

/** Least and greatest intensity of the readings. It widens at once, and narrows only when it is far too wide. */
export function intensityDomain(scan: Scan, previous: Domain | null): Domain | null {
  let [low, high] = [Infinity, -Infinity];
  for (const [i, value] of scan.intensities.entries()) {
    if (scan.kinds[i] !== READING || !Number.isFinite(value)) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  if (low > high) return null;
  if (!previous) return [low, high];
  const widened: Domain = [Math.min(low, previous[0]), Math.max(high, previous[1])];
  return widened[1] - widened[0] > 2 * (high - low) ? [low, high] : widened;
}

/** Colour of an intensity, without the end of viridis that is too close to the background. */
export function colorScale([low, high]: Domain, dark: boolean): (intensity: number) => string {
  const colors = viridisFor(dark);
  const width = high - low || 1;
  return (intensity) => {
    const step = Math.floor(((intensity - low) / width) * colors.length);
    return colors[Math.min(colors.length - 1, Math.max(0, step))] ?? "gray";
  };
}

/** The scale of the colours, in the lower right corner; it takes `SCALE_HEIGHT` pixels. */
export const SCALE_HEIGHT = 24;

export function drawColorScale(
  context: CanvasRenderingContext2D,
  { width, height }: { width: number; height: number },
  domain: Domain,
  colorOf: (intensity: number) => string,
  theme: Theme,
): void {
  const [bar, thick, right, top] = [110, 8, width - 12, height - SCALE_HEIGHT + 6];
  const [low, high] = domain.map((value) => toFixed(value, Number.isInteger(value) ? 0 : 2)) as [string, string];
  const say = (text: string, x: number) =>
    write(context, text, x, top + thick / 2, theme.muted, textFont(theme), "right");
  say(high, right);
  const barRight = right - context.measureText(high).width - 6;
  for (let x = 0; x < bar; x++) {
    context.fillStyle = colorOf(domain[0] + ((x + 0.5) / bar) * (domain[1] - domain[0]));
    context.fillRect(barRight - bar + x, top, 1.5, thick);
  }
  say(`intensity ${low}`, barRight - bar - 6);
}
