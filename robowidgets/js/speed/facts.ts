import { type Axis, GROUPS, isShown } from "./axes.ts";
import type { Speeds } from "./frame.ts";
import { type LimitSettings, limitsOf } from "./limits.ts";
import { type Scale, sharedLimits, toScales } from "./scale.ts";
import { decimalsFor } from "./text.ts";
import type { Limits } from "./traits.ts";

/** All data of one axis; speeds in its unit. */
export interface AxisFacts {
  axis: Axis;
  unit: string;
  /** Null before the first; NaN where there is no value. */
  measured: number | null;
  commanded: number | null;
  /** Least and greatest; null when peaks are not marked. */
  peaks: [number, number] | null;
  limits: Limits;
  scale: Scale;
  /** With how many decimals its numbers are shown. */
  decimals: number;
}

/** All data of the axes of a group, which share a scale. */
export interface GroupFacts {
  scale: Scale;
  /** The limits that all axes on show have; null when they differ. */
  shared: Limits | null;
  axes: AxisFacts[];
  hidden: AxisFacts[];
}

export interface Settings {
  limits: LimitSettings;
  planar: boolean;
  marksPeaks: boolean;
}

/** What the groups show. */
export function toFacts(speeds: Speeds | null, { limits, planar, marksPeaks }: Settings): GroupFacts[] {
  const onShow = GROUPS.map((group) =>
    group.axes.filter((axis) => isShown(axis, planar)).map((axis) => limitsOf(limits, group, axis)),
  );
  const scales = toScales(onShow);
  return GROUPS.map((group, g) => {
    const [scale, groupLimits] = [scales[g] as Scale, onShow[g] as Limits[]];
    const decimals = decimalsFor(groupLimits);
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
