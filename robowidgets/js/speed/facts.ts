import { decimalsFor as decimalsUpTo } from "../shared/format.ts";
import type { Speeds } from "../shared/frames/speeds.ts";
import { type Axis, type Group, groupsOf, isShown, layoutOf } from "./axes.ts";
import { type LimitSettings, limitsOf } from "./limits.ts";
import { type Scale, sharedLimits, toReach, toScales } from "./scale.ts";
import type { Limits } from "./traits.ts";

/** All data of one axis; speeds in its unit. */
export interface AxisFacts {
  axis: Axis;
  unit: string;
  /** Null before the first; NaN without a value. */
  measured: number | null;
  commanded: number | null;
  /** Least and greatest; null if peaks are not marked. */
  peaks: [number, number] | null;
  /** Null without. */
  limits: Limits | null;
  scale: Scale;
  /** Number of decimals of its numbers. */
  decimals: number;
}

/** All data of the axes of a group, which share a scale. */
export interface GroupFacts {
  scale: Scale;
  /** The limits that all axes on show share; null if they differ or are missing. */
  shared: Limits | null;
  axes: AxisFacts[];
  hidden: AxisFacts[];
}

interface Settings {
  limits: LimitSettings;
  planar: boolean;
  marksPeaks: boolean;
  /** For axes without limits. */
  fastest: Fastest;
}

/** The fastest speed so far, by group. */
export type Fastest = Record<Group["name"], number>;

/** The fastest speed of axes on show, including the peaks and the earlier speeds. */
export function toFastest(speeds: Speeds | null, planar: boolean, before: Fastest): Fastest {
  const fastest = { ...before };
  for (const values of speeds ? [speeds.measured, speeds.commanded, speeds.least, speeds.greatest] : []) {
    for (const group of groupsOf(layoutOf(speeds))) {
      for (const axis of group.axes.filter((axis) => isShown(axis, planar))) {
        const size = Math.abs(values?.[axis.index] ?? 0);
        if (Number.isFinite(size) && size > fastest[group.name]) fastest[group.name] = size;
      }
    }
  }
  return fastest;
}

/** Returns true if peaks are known: not before the first speed, and not in a player. */
export function hasPeaks(speeds: Speeds | null): boolean {
  return speeds?.least.some((value) => !Number.isNaN(value)) ?? false;
}

/** The facts of the groups on show. */
export function toFacts(speeds: Speeds | null, { limits, planar, marksPeaks, fastest }: Settings): GroupFacts[] {
  const every = groupsOf(layoutOf(speeds));
  const onShow = every.map((group) =>
    group.axes.filter((axis) => isShown(axis, planar)).map((axis) => limitsOf(limits, group, axis)),
  );
  const bounds = every.map((group, g) => {
    const reach = toReach(fastest[group.name]);
    return (onShow[g] ?? []).map((pair): Limits => pair ?? [-reach, reach]);
  });
  const scales = toScales(bounds);
  return every.map((group, g) => {
    const [scale, groupLimits] = [scales[g] as Scale, onShow[g] as (Limits | null)[]];
    const decimals = decimalsFor(bounds[g] as Limits[]);
    const toAxisFacts = (axis: Axis): AxisFacts => ({
      ...toSpeeds(speeds, axis, marksPeaks),
      axis,
      unit: group.unit,
      limits: limitsOf(limits, group, axis),
      scale,
      decimals,
    });
    return {
      scale,
      shared: sharedLimits(groupLimits),
      axes: group.axes.filter((axis) => isShown(axis, planar)).map(toAxisFacts),
      hidden: group.axes.filter((axis) => !isShown(axis, planar)).map(toAxisFacts),
    };
  });
}

function toSpeeds(speeds: Speeds | null, { index }: Axis, marksPeaks: boolean) {
  const peaks: [number, number] | null =
    speeds && marksPeaks ? [speeds.least[index] ?? NaN, speeds.greatest[index] ?? NaN] : null;
  return { measured: speeds?.measured?.[index] ?? null, commanded: speeds?.commanded?.[index] ?? null, peaks };
}

/** Number of decimals that distinguish speeds within limits: two, and more if all limits are below 0.1. */
export function decimalsFor(limits: Limits[]): number {
  return decimalsUpTo(Math.max(...limits.flat().map(Math.abs)));
}
