/* The rules by which a source or a kernel counts as silent, and pictures as stale, by their names. Python's rules are
   in robowidgets/samples/staleness.py. */

/**
 * Milliseconds without a message after which a source on show, with this usual step, is silent: the picture turns pale,
 * lamps are unknown, lines are broken. An infinite step is unknown.
 */
export function silentAfter(step: number): number {
  return Math.min(10_000, Math.max(1000, 3 * step));
}

/** Milliseconds without a message after which a topic of a list, or a wire, with this usual step is silent. */
export function listedSilentAfter(step: number): number {
  return Math.max(3000, 3 * step);
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

/** The median time to the next later time; infinite without one. */
export function usualStep(times: number[]): number {
  const steps = Float64Array.from(times.slice(1), (time, i) => time - (times[i] as number))
    .filter((step) => step > 0)
    .sort();
  const { length } = steps;
  return length ? ((steps[(length - 1) >> 1] as number) + (steps[length >> 1] as number)) / 2 : Infinity;
}
