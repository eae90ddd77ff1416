import { type Box, holds, isWithin, overlaps, type Point, type Size } from "../shared/box.ts";
import { crosses } from "../shared/popup_place.ts";
import type { Theme } from "../shared/theme.ts";
import { pointAt, rimOf } from "./draw_sector.ts";
import type { Stage } from "./layer.ts";
import { type Sector, sweepOf } from "./sector.ts";

const MARGIN = 10;

/**
 * The corner of the picture for a chip, near its sector: it covers no ray of the sector, no reading, no label and no
 * other element. Null if there is no such corner.
 *
 * @param before its present place, which it keeps as long as possible; one of the covered boxes of the stage
 */
export function placeChip({ width, height }: Size, stage: Stage, sector: Sector, before: Box | null): Box | null {
  const { box, occupied, labels, covered, projection } = stage;
  const [left, top] = [box.x + MARGIN, box.y + MARGIN];
  const right = Math.max(left, box.x + box.width - width - MARGIN);
  const bottom = Math.max(top, box.y + box.height - height - MARGIN);
  const rim = rimOf(stage);
  const wedge = [0.05, 0.25, 0.4, 0.55, 0.7, 0.85, 1].flatMap((far) =>
    [0, 0.25, 0.5, 0.75, 1].map((part) => pointAt(projection, far * rim, sector.start + part * sweepOf(sector))),
  );
  const middle = pointAt(projection, rim, sector.start + sweepOf(sector) / 2);
  const away = ({ x, y }: Box) => Math.hypot(x + width / 2 - middle.x, y + height / 2 - middle.y);
  const corners = [left, right].flatMap((x) => [top, bottom].map((y) => ({ x, y, width, height })));
  corners.sort((a, b) => away(a) - away(b));
  const stay = before && { x: before.x <= left ? left : right, y: before.y <= top ? top : bottom, width, height };
  const others = [...labels, ...covered.filter((other) => other !== before)];
  const isFree = (place: Box) =>
    isWithin(place, box) &&
    !wedge.some((point) => holds(place, point)) &&
    !others.some((other) => overlaps(place, other)) &&
    !occupied.count(place);
  return (stay ? [stay, ...corners] : corners).find(isFree) ?? null;
}

/** Draws a line from a handle to the chip outside the area, unless every such line crosses a label. */
export function leadTo(context: CanvasRenderingContext2D, stage: Stage, sector: Sector, chip: Box, theme: Theme): void {
  const end = { x: chip.x + (chip.x < stage.size.width / 2 ? chip.width : 0), y: chip.y + 18 };
  const outward = Math.sign(end.x - stage.size.width / 2);
  const lines = [sector.start, sector.end].flatMap((angle) => {
    const start = pointAt(stage.projection, rimOf(stage) + 6, angle);
    const bend = { x: start.x + outward * Math.abs(start.y - end.y), y: end.y };
    return [[start, end], ...((end.x - bend.x) * outward > 0 ? [[start, bend, end]] : [])];
  });
  const { centerX, centerY } = stage.projection;
  const isOutside = ({ x, y }: Point) => Math.hypot(x - centerX, y - centerY) > rimOf(stage);
  const between = (a: Point, b: Point) =>
    [0.02, 0.25, 0.5, 0.75].map((part) => ({ x: a.x + part * (b.x - a.x), y: a.y + part * (b.y - a.y) }));
  const isClear = (line: Point[]) =>
    line.slice(1).every((to, i) => {
      const from = line[i] as Point;
      return between(from, to).every(isOutside) && stage.labels.every((label) => !crosses(from, to, label));
    });
  const length = (line: Point[]) =>
    line.slice(1).reduce((sum, { x, y }, i) => sum + Math.hypot(x - (line[i]?.x ?? x), y - (line[i]?.y ?? y)), 0);
  const [line] = lines.filter(isClear).sort((a, b) => length(a) - length(b));
  if (!line) return;
  context.beginPath();
  for (const { x, y } of line) context.lineTo(x, y);
  context.strokeStyle = theme.pointer;
  context.lineWidth = 1;
  context.stroke();
}
