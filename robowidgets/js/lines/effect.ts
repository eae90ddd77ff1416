import type { Theme } from "../shared/theme.ts";
import type { EffectAxis } from "./traits.ts";

const MARGIN = 4;

/** The speeds of the last seconds: the version in force as a wide pale curve, the new one as a thin one over it. */
export function drawEffect(
  canvas: HTMLCanvasElement,
  { at, old, new: now }: EffectAxis,
  { ink, guide, ghost, pointer, mono }: Pick<Theme, "ink" | "guide" | "ghost" | "pointer" | "mono">,
  ratio: number,
): void {
  const { clientWidth: width, clientHeight: height } = canvas;
  const context = canvas.getContext("2d");
  if (!context || !width) return;
  [canvas.width, canvas.height] = [Math.round(width * ratio), Math.round(height * ratio)];
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  const levels = [...old, ...now].filter((level) => level !== null);
  const [low, high] = [Math.min(0, ...levels), Math.max(0, ...levels)];
  const toY = (level: number) => height - MARGIN - ((height - 2 * MARGIN) * (level - low)) / (high - low || 1);
  const [first = 0] = at;
  const last = at.at(-1) ?? 0;
  context.font = `10px ${mono}`;
  const labels = [high, low].filter((level) => level !== 0);
  const left = 6 + Math.max(...labels.map((level) => context.measureText(String(level)).width));
  const toX = (time: number) => left + ((width - left - 1) * (time - first)) / (last - first || 1);
  context.strokeStyle = guide;
  context.lineWidth = 1;
  context.setLineDash([2, 3]);
  context.beginPath();
  context.moveTo(left, Math.round(toY(0)) + 0.5);
  context.lineTo(width, Math.round(toY(0)) + 0.5);
  context.stroke();
  context.setLineDash([]);
  context.fillStyle = ink;
  for (const level of labels) context.fillText(String(level), 0, Math.min(height, Math.max(8, toY(level) + 3)));
  for (const [curve, colour, size] of [
    [old, ghost, 4],
    [now, pointer, 1.5],
  ] as const) {
    context.strokeStyle = colour;
    context.lineWidth = size;
    context.beginPath();
    let before: number | null = null;
    for (const [i, level] of curve.entries()) {
      if (level !== null) {
        const x = toX(at[i] ?? 0);
        // A speed is held until the next step.
        if (before === null) context.moveTo(x, toY(level));
        else context.lineTo(x, toY(before));
        context.lineTo(x, toY(level));
      }
      before = level;
    }
    context.stroke();
  }
}
