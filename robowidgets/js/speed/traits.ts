import type { SampleTraits } from "../shared/traits.ts";

/** Least and greatest, in m/s or rad/s; zero lies between them. */
export type Limits = [number, number];

export interface SpeedTraits extends SampleTraits {
  /** Null: no limits. */
  linear_limits: Limits | null;
  angular_limits: Limits | null;
  /** Of single axes, like "linear.x", in place of those of their group. */
  limits: Record<string, Limits>;
  planar: boolean;
  hold_peaks: boolean;
  command_title: string;
  bars: "measured" | "commanded";
  /** Seconds that are shown below the bars; 0: none. */
  over_time: number;
  /** How often the peaks were reset. */
  _resets: number;
}
