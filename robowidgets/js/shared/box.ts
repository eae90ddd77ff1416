import type { Size } from "./canvas.ts";

export interface Point {
  x: number;
  y: number;
}

export interface Box extends Point, Size {}

export function holds({ x, y, width, height }: Box, point: Point): boolean {
  return point.x >= x && point.x <= x + width && point.y >= y && point.y <= y + height;
}
