import { write } from "../shared/canvas.ts";
import type { Theme } from "../shared/theme.ts";
import { HANDLE, PICKED_OPACITY, SECTOR_OPACITY } from "./draw_sector.ts";
import type { Depth, StripPainter, StripStage } from "./layer.ts";
import type { Sector, Stretch } from "./sector.ts";
import type { SectorNumbers } from "./sector_numbers.ts";
import type { Named } from "./sector_store.ts";

type Context = CanvasRenderingContext2D;

/** The painters of sectors in the index view. */
export function sectorStrip(
  all: Named[],
  picked: Named | null,
  numbers: SectorNumbers,
): Partial<Record<Depth, StripPainter>> {
  if (!all.length) return {};
  const isPicked = ({ name }: Named) => picked?.name === name;
  const draw = (strip: StripStage, paint: (one: Named, stretches: Stretch[]) => void) => {
    for (const one of all) if (strip.scan) paint(one, numbers.look(strip.scan, one.sector).stretches);
  };
  return {
    fills: (context, strip, theme) =>
      draw(strip, (one, stretches) => {
        const fill = isPicked(one)
          ? { color: theme.pointer, opacity: PICKED_OPACITY }
          : { color: theme.ink, opacity: SECTOR_OPACITY };
        for (const stretch of stretches) fillStretch(context, strip, stretch, fill);
      }),
    edges: (context, strip, theme) =>
      draw(strip, (one, stretches) => {
        for (const stretch of stretches) drawStretch(context, strip, stretch, one.sector, isPicked(one), theme);
      }),
    names: (context, strip, theme) => {
      const taken: Span[] = [];
      draw(strip, (one, stretches) => {
        const color = isPicked(one) ? theme.pointer : theme.ink;
        if (one.name) drawName(context, strip, stretches, one.name, color, theme, taken);
      });
    },
    handles: (context, strip, theme) =>
      draw(strip, (one, stretches) => {
        if (isPicked(one)) drawHandles(context, strip, stretches, theme);
      }),
  };
}

/** Pixels from the left. */
type Span = [from: number, to: number];

/** Start and end of a stretch in the index view; a single ray has a width, too. */
function endsOf({ xOf }: StripStage, [start, stop]: Stretch): [number, number] {
  return [xOf(start - 0.5), xOf(stop - 0.5)];
}

export function fillStretch(
  context: Context,
  strip: StripStage,
  stretch: Stretch,
  { color, opacity }: { color: string; opacity: number },
): void {
  const [left, right] = endsOf(strip, stretch);
  context.globalAlpha = opacity;
  context.fillStyle = color;
  context.fillRect(left, strip.box.y, right - left, strip.box.height);
  context.globalAlpha = 1;
}

/** The rim of a stretch at the top, its edges, and the limits of its sector as dashed lines. */
function drawStretch(
  context: Context,
  strip: StripStage,
  stretch: Stretch,
  sector: Sector,
  isPicked: boolean,
  theme: Theme,
): void {
  const [left, right] = endsOf(strip, stretch);
  const { y, height } = strip.box;
  const color = isPicked ? theme.pointer : theme.muted;
  context.fillStyle = color;
  const thick = isPicked ? 3.5 : 2.5;
  context.fillRect(left, y - thick / 2, right - left, thick);
  if (isPicked) for (const x of [left, right]) context.fillRect(x - 0.75, y, 1.5, height);
  context.strokeStyle = color;
  context.lineWidth = 1.25;
  context.setLineDash([5, 3]);
  for (const limit of [sector.near, sector.warning, sector.stop]) {
    if (limit === undefined || limit > strip.viewRange) continue;
    context.beginPath();
    context.moveTo(left, strip.yOf(limit));
    context.lineTo(right, strip.yOf(limit));
    context.stroke();
  }
  context.setLineDash([]);
}

/** The handles of a picked sector, at its first and its last ray. */
function drawHandles(context: Context, strip: StripStage, stretches: Stretch[], theme: Theme): void {
  const [first, last] = [stretches[0], stretches.at(-1)];
  if (!first || !last) return;
  for (const x of [endsOf(strip, first)[0], endsOf(strip, last)[1]]) {
    context.beginPath();
    context.arc(x, strip.box.y, HANDLE - 1, 0, 2 * Math.PI);
    context.fillStyle = theme.background;
    context.fill();
    context.strokeStyle = theme.pointer;
    context.lineWidth = 2.25;
    context.stroke();
  }
}

/** The name of a sector within its widest stretch, if that is wide enough and free of other names. */
function drawName(
  context: Context,
  strip: StripStage,
  stretches: Stretch[],
  name: string,
  color: string,
  theme: Theme,
  taken: Span[],
): void {
  const [widest] = [...stretches].sort((a, b) => b[1] - b[0] - (a[1] - a[0]));
  if (!widest) return;
  const [left, right] = endsOf(strip, widest);
  const font = `650 12px ${theme.font}`;
  context.font = font;
  const half = context.measureText(name).width / 2 + 4;
  if (2 * half > right - left) return;
  const middle = [(left + right) / 2, left + half, right - half].find((x) =>
    taken.every(([from, to]) => x + half <= from || x - half >= to),
  );
  if (middle === undefined) return;
  taken.push([middle - half, middle + half]);
  write(context, name, middle, strip.box.y + 12, color, font, "center");
}
