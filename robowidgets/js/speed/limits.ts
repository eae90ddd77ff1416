import type { Axis, Group } from "./axes.ts";
import type { Limits } from "./traits.ts";

/** What a value is to its limits. */
export type State = "within" | "over" | "under" | "none";

/** The limits as Python sets them: by group, and by axis instead of those. */
export interface LimitSettings {
  linear: Limits;
  angular: Limits;
  axes: Record<string, Limits>;
}

/** As in Python: past a limit by more than rounding. */
const ROUNDING = 1e-6;

export function judge(value: number, [low, high]: Limits): State {
  if (Number.isNaN(value)) return "none";
  if (value > high + ROUNDING * Math.max(1, Math.abs(high))) return "over";
  if (value < low - ROUNDING * Math.max(1, Math.abs(low))) return "under";
  return "within";
}

/** The limits of an axis: its own, else those of its group. */
export function limitsOf(settings: LimitSettings, group: Group, axis: Axis): Limits {
  return settings.axes[axis.name] ?? settings[group.name];
}
