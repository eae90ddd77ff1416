/**
 * Differences of red, green and blue from step to step: digits of base 36, minus seven. Whole colours would take twice
 * the bytes in the bundle, and the package would bring all its maps.
 */
const STEPS =
  "7779dd8dd7dc8cc7cc7dc7cb6ca6ca6ca6ba5c95c95b86c84c85c85b85b75b86b75b75b76a75b76b75b76a75b76b65b7" +
  "6b66b67b67b67a59b59b5ab5ba5cb4da4db3ea3fa3fb3fa2ia1ga1ga2h91ha0h91i90h90i90i81h91i82h85i99h8bg8e";

/** Viridis in 64 even steps from dark to light, the same as in d3-scale-chromatic, which a test checks. */
export const VIRIDIS = toColors([68, 1, 84]);

/** Viridis without the end that is too close to the background. */
export function viridisFor(dark: boolean): string[] {
  return dark ? VIRIDIS.slice(16) : VIRIDIS.slice(0, 54);
}

function toColors(rgb: number[]): string[] {
  return (STEPS.match(/.../g) ?? []).map((step) => {
    rgb = rgb.map((value, i) => value + Number.parseInt(step.charAt(i), 36) - 7);
    return `#${rgb.map((value) => value.toString(16).padStart(2, "0")).join("")}`;
  });
}
