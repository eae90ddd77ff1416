/**
 * Round numbers from one number to a larger one, at steps of 1, 2 or 5 times a power of ten, about `count` of them. The
 * function of d3-array takes twenty times the bytes, because it brings its whole file.
 */
export function ticks(from: number, to: number, count: number): number[] {
  const span = to - from;
  if (!(span > 0 && count > 0)) return [];
  const rough = span / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const error = rough / power;
  const step = power * (error >= Math.sqrt(50) ? 10 : error >= Math.sqrt(10) ? 5 : error >= Math.SQRT2 ? 2 : 1);
  const [first, last] = [Math.ceil(from / step - 1e-9), Math.floor(to / step + 1e-9)];
  // Short decimals: 3 times 0.1 is not 0.3.
  return Array.from({ length: last - first + 1 }, (_, i) => Number(((first + i) * step).toPrecision(12)));
}
