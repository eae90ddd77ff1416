import { MINUTE, toFixed, toMinutes } from "./format.ts";
import type { Span } from "./time_axis.ts";

const ROUNDING = 1e-9;

/** Steps of seconds, minutes and hours. */
const ROUND = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 10_800, 21_600, 43_200];
const DAY = 86_400;

/** Round times that divide a span in at most about so many parts, in the form for a recording of a length. */
export function timeTicks([start, end]: Span, count: number, whole = end): { time: number; text: string }[] {
  const rough = ((end - start) / count) * 0.999;
  const step =
    whole >= MINUTE && rough > 0.5
      ? (ROUND.find((one) => one >= rough) ?? decimalStep(rough, DAY))
      : decimalStep(rough);
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + ROUNDING));
  const [first, last] = [Math.ceil(start / step - ROUNDING), Math.floor(end / step + ROUNDING)];
  return Array.from({ length: last - first + 1 }, (_, i) => {
    const time = (first + i) * step;
    return { time, text: toMoment(time, whole, decimals) };
  });
}

/** 1, 2 or 5 times a power of ten, in a unit. */
function decimalStep(rough: number, unit = 1): number {
  const power = 10 ** Math.floor(Math.log10(rough / unit));
  return unit * power * ([1, 2, 5].find((digit) => digit * power * unit >= rough) ?? 10);
}

/** A time in the form of the axis: "41.20 s", and "4:05.20" in a recording of a minute or more. */
export function toMoment(time: number, whole: number, decimals = 2): string {
  return whole < MINUTE ? toSeconds(time, decimals) : toMinutes(time, decimals, whole);
}

/** "41.20 s" */
export function toSeconds(time: number, decimals = 2): string {
  return `${toFixed(time, decimals)} s`;
}

/** A span made longer or shorter by a factor, with one of its times staying at its place, within the whole. */
export function zoomed([start, end]: Span, factor: number, around: number, whole: Span, shortest: number): Span {
  const most = whole[1] - whole[0];
  const length = Math.min(most, Math.max(Math.min(most, shortest), (end - start) * factor));
  const part = (around - start) / (end - start);
  return kept([around - part * length, around + (1 - part) * length], whole);
}

/** A span moved by seconds, within the whole. */
export function moved([start, end]: Span, by: number, whole: Span): Span {
  return kept([start + by, end + by], whole);
}

function kept([start, end]: Span, [first, last]: Span): Span {
  const length = end - start;
  const from = Math.min(Math.max(first, last - length), Math.max(first, start));
  return [from, from + length];
}
