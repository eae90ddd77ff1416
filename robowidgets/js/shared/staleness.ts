/*
 * When what is on show is stale: the rules by which a source or a kernel counts as silent, by their names. Python's own
 * are in robowidgets/samples/staleness.py.
 */

/** How long a source may send nothing: so many of its usual steps, and at least and at most so many milliseconds. */
export interface SilenceRule {
  steps: number;
  shortest: number;
  longest: number;
}

/** Of a source that is on show now: the picture turns pale, lamps are unknown, lines are broken. */
export const LIVE: SilenceRule = { steps: 3, shortest: 1000, longest: 10_000 };

/** Milliseconds without a message after which a source with this usual step is silent; infinite: it is unknown. */
export function silentAfter(rule: SilenceRule, step: number): number {
  return Math.min(rule.longest, Math.max(rule.shortest, rule.steps * step));
}

/** Least length of a gap between two scans of a scanogram, relative to the 90th percentile of all steps. */
export const SCAN_GAP_STEPS = 3;

/** Milliseconds between two signs of life of a kernel, and between two of a page. */
export const BEAT_MS = 1000;

/** Milliseconds without a message, after which the kernel is silent. */
export const KERNEL_SILENT_MS = 2.5 * BEAT_MS;

/** Milliseconds without an answer after which a kernel counts as busy. */
export const KERNEL_BUSY_MS = 1.5 * BEAT_MS;

/** Milliseconds without an answer after which the press of a pad is over. */
export const PRESS_SILENT_MS = 500;

/** The median time to the next later time; infinite if there is none. */
export function usualStep(times: number[]): number {
  const steps = Float64Array.from(times.slice(1), (time, i) => time - (times[i] as number))
    .filter((step) => step > 0)
    .sort();
  const middle = steps.length / 2;
  const low = steps[Math.ceil(middle) - 1] ?? Infinity;
  return (low + (steps[Math.floor(middle)] ?? low)) / 2;
}
