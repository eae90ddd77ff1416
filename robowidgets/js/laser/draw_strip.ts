import { write } from "../shared/canvas.ts";
import {
  NO_MEASUREMENT,
  NOTHING_IN_RANGE,
  OUTSIDE_LIMITS,
  READING,
  type Scan,
  TOO_CLOSE,
} from "../shared/frames/scan.ts";
import type { Theme } from "../shared/theme.ts";
import type { StripStage } from "./layer.ts";

const DOT = 2.5;
/** Pixels above the plot at which rays without a distance in view are marked. */
const LANE = 5;
/** Pixels between two marks of the same kind. */
const SPACING = 4;
const MARK = 1.5;
const RING = 5;

/** A dot for each ray: readings in their colour; nothing in range is a dotted line above, no measurement a gap. */
export function drawStripReadings(
  context: CanvasRenderingContext2D,
  { box, viewRange, xOf, yOf }: StripStage,
  scan: Scan,
  theme: Theme,
  colorOf: ((intensity: number) => string) | null,
): void {
  const top = box.y - LANE;
  let last = { kind: -1, x: -Infinity };
  for (let i = 0; i < scan.count; i++) {
    const kind = scan.kinds[i] as number;
    const range = scan.ranges[i] as number;
    const x = xOf(i);
    const isInView = range >= 0 && range <= viewRange;
    if (kind === READING && isInView) {
      context.fillStyle = colorOf ? colorOf(scan.intensities[i] as number) : theme.reading;
      context.fillRect(x - DOT / 2, yOf(range) - DOT / 2, DOT, DOT);
      continue;
    }
    if (kind === NO_MEASUREMENT || (last.kind === kind && x - last.x < SPACING)) continue;
    last = { kind, x };
    context.fillStyle = kind === READING ? theme.reading : theme.muted;
    let y = top;
    if (kind === TOO_CLOSE) y = yOf(0);
    else if (kind === OUTSIDE_LIMITS && isInView) y = yOf(range);
    else if (kind !== READING && kind !== NOTHING_IN_RANGE && kind !== OUTSIDE_LIMITS) continue;
    context.fillRect(x - MARK / 2, y - MARK / 2, MARK, kind === READING ? 2 * MARK : MARK);
  }
}

/** The ray that a pop-up names: a line through the plot, its index above, and a ring at its reading. */
export function drawStripPointer(
  context: CanvasRenderingContext2D,
  { box, viewRange, size, xOf, yOf }: StripStage,
  scan: Scan,
  index: number,
  theme: Theme,
): void {
  const x = xOf(index);
  const range = scan.ranges[index] as number;
  const isShown = scan.kinds[index] === READING && range <= viewRange;
  const font = `600 11px ${theme.mono}`;
  context.font = font;
  const half = context.measureText(`[${index}]`).width / 2 + 4;
  const middle = Math.min(size.width - half, Math.max(half, x));
  context.fillStyle = theme.background;
  context.fillRect(middle - half, box.y - 20, 2 * half, 14);
  write(context, `[${index}]`, middle, box.y - 13, theme.pointer, font, "center");
  context.strokeStyle = theme.pointer;
  context.lineWidth = 1.25;
  context.beginPath();
  context.moveTo(x, box.y - 6);
  context.lineTo(x, box.y + box.height);
  context.stroke();
  if (!isShown) return;
  context.beginPath();
  context.arc(x, yOf(range), RING, 0, 2 * Math.PI);
  context.lineWidth = 2;
  context.stroke();
}
