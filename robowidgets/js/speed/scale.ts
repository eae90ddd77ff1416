import { ticks } from "../shared/ticks.ts";
import type { Limits } from "./traits.ts";

/** The speeds at the lower and the upper end of a track. */
export interface Scale {
  low: number;
  high: number;
}

/** A number next to the tracks, at a height from 0 (the lower end) to 1. */
interface Label {
  value: number;
  height: number;
  /** A round number between zero and the limits, hidden in a narrow card. */
  round: boolean;
}

/** Room beyond the limits on either side, as a part of the range between them. */
const HEADROOM = 0.125;
/** Noise of a robot that stands still is not drawn large, and an absurd speed is drawn cut. */
const LEAST_REACH = 0.1;
const MOST_REACH = 1e6;
const TICK_COUNT = 5;
/** Least distance of labels, as a part of the track. */
export const CLEARANCE = 0.09;
/** Pixels that a label takes. */
const LABEL = 11;

/**
 * One scale per group of axes, from the limits of each: it holds them all and some room beyond, and zero lies at the
 * same height in every group.
 */
export function toScales(groups: Limits[][]): Scale[] {
  const reaches = groups.map((limits) => {
    const low = Math.min(...limits.map(([min]) => min));
    const high = Math.max(...limits.map(([, max]) => max));
    const span = high - low;
    return { span, down: HEADROOM - low / span, up: HEADROOM + high / span };
  });
  const down = Math.max(...reaches.map((reach) => reach.down));
  const up = Math.max(...reaches.map((reach) => reach.up));
  return reaches.map(({ span }) => ({ low: -down * span, high: up * span }));
}

/**
 * The height of a speed on its track: 0 at the lower end, 1 at the upper; outside of them for a speed off the scale.
 */
export function toHeight({ low, high }: Scale, value: number): number {
  return (value - low) / (high - low);
}

/** The height at which something is drawn: on the track. */
export function toHeightOnTrack(scale: Scale, value: number): number {
  return Math.min(1, Math.max(0, toHeight(scale, value)));
}

/** Returns true if a speed lies beyond the scale, and is drawn cut. */
export function isOff(value: number, { low, high }: Scale): boolean {
  return value < low || value > high;
}

/** Least distance of labels, as a part of a track of some pixels; 0 before its size is known. */
export function toClearance(pixels: number): number {
  return Math.max(CLEARANCE, LABEL / (pixels || Infinity));
}

/** The limits that all axes share; null if they differ or are missing. */
export function sharedLimits(limits: (Limits | null)[]): Limits | null {
  const [first] = limits;
  return first && limits.every((pair) => pair?.[0] === first[0] && pair?.[1] === first[1]) ? first : null;
}

/** The end of the scale of an axis without limits: the next 1, 2 or 5 that holds the fastest speed. */
export function toReach(fastest: number): number {
  const size = Math.min(MOST_REACH, Math.max(LEAST_REACH, fastest));
  const power = Math.floor(Math.log10(size));
  const steps = [1, 2, 5, 10].map((step) => Number(`${step}e${power}`));
  return steps.find((step) => step >= size) ?? size;
}

/** The numbers next to the tracks: the limits that all axes share, and zero and round ones if they have room. */
export function scaleLabels(scale: Scale, shared: Limits | null, clearance: number): Label[] {
  const toLabel = (value: number, round: boolean): Label => ({ value, height: toHeight(scale, value), round });
  const labels = (shared ?? []).map((value) => toLabel(value, false));
  const rounds = ticks(scale.low, scale.high, TICK_COUNT).map((value) => toLabel(value, shared !== null));
  for (const label of [toLabel(0, false), ...rounds]) {
    const isFree = labels.every(({ height }) => Math.abs(height - label.height) >= clearance);
    if (isFree && label.height >= CLEARANCE / 2 && label.height <= 1 - CLEARANCE / 2) labels.push(label);
  }
  return labels;
}
