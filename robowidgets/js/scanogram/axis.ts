import { toFixed } from "../shared/format.ts";
import type { Span } from "./traits.ts";

const ROUNDING = 1e-9;

/** Where seconds stand across the picture: from `left` on, over `width` pixels. */
export interface TimeAxis {
  span: Span;
  left: number;
  width: number;
}

export function toX({ span: [start, end], left, width }: TimeAxis, time: number): number {
  return left + ((time - start) / (end - start)) * width;
}

export function toTime({ span: [start, end], left, width }: TimeAxis, x: number): number {
  return start + (Math.min(width, Math.max(0, x - left)) / width) * (end - start);
}

/** Times with round numbers that divide a span in at most about so many parts, and how they are written. */
export function timeTicks([start, end]: Span, count: number): { time: number; text: string }[] {
  const rough = ((end - start) / count) * 0.999;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5].find((digit) => digit * power >= rough) ?? 10);
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + ROUNDING));
  const [first, last] = [Math.ceil(start / step - ROUNDING), Math.floor(end / step + ROUNDING)];
  return Array.from({ length: last - first + 1 }, (_, i) => {
    const time = (first + i) * step;
    return { time, text: toSeconds(time, decimals) };
  });
}

/** "41.20 s" */
export function toSeconds(time: number, decimals = 2): string {
  return `${toFixed(time, decimals)} s`;
}

/** A span made longer or shorter by a factor, with one of its times staying where it is, within the whole. */
export function zoomed([start, end]: Span, factor: number, around: number, whole: number, shortest: number): Span {
  const length = Math.min(whole, Math.max(Math.min(whole, shortest), (end - start) * factor));
  const part = (around - start) / (end - start);
  return kept([around - part * length, around + (1 - part) * length], whole);
}

/** A span moved by seconds, within the whole. */
export function moved([start, end]: Span, by: number, whole: number): Span {
  return kept([start + by, end + by], whole);
}

function kept([start, end]: Span, whole: number): Span {
  const length = end - start;
  const from = Math.min(Math.max(0, whole - length), Math.max(0, start));
  return [from, from + length];
}
