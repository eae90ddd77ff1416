import type { SampleTraits } from "../shared/traits.ts";

/** Least and greatest, in m/s or rad/s; zero lies between them. */
export type Limits = [number, number];

export interface SpeedTraits extends SampleTraits {
  /** Null for no limits. */
  linear_limits: Limits | null;
  angular_limits: Limits | null;
  /** Limits of single axes, like "linear.x", which replace the limits of their group. */
  limits: Record<string, Limits>;
  planar: boolean;
  hold_peaks: boolean;
  command_title: string;
  bars: "measured" | "commanded";
  /** Seconds that are shown below the bars, or 0 for none. */
  over_time: number;
  /** Number of resets of the peaks. */
  _resets: number;
}
