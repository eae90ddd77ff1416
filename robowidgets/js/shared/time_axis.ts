/** Seconds from the start. */
export type Span = [number, number];

/** Maps seconds to the picture: from `left` on, over `width` pixels. */
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
