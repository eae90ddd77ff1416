import type { Axis, Group } from "./axes.ts";
import type { Limits } from "./traits.ts";

/** The state of a value within or past its limits. */
export type State = "within" | "over" | "under" | "none";

/** The limits as Python sets them: by group, and by axis instead of those. */
export interface LimitSettings {
  linear: Limits | null;
  angular: Limits | null;
  axes: Record<string, Limits>;
}

/** As in Python: past a limit by more than rounding. */
const ROUNDING = 1e-6;

export function judge(value: number, limits: Limits | null): State {
  if (Number.isNaN(value)) return "none";
  if (!limits) return "within";
  const [low, high] = limits;
  if (value > high + ROUNDING * Math.max(1, Math.abs(high))) return "over";
  if (value < low - ROUNDING * Math.max(1, Math.abs(low))) return "under";
  return "within";
}

/** The limits of an axis itself, else of its group; null without limits. */
export function limitsOf(settings: LimitSettings, group: Group, axis: Axis): Limits | null {
  return settings.axes[axis.name] ?? (group.name === "steering" ? null : settings[group.name]);
}
