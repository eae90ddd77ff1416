import { onAbort } from "./events.ts";

/** Rays of a robot's scan that a line of its program read: first and stop of each run, and the one that decided, or -1. */
export interface Lit {
  runs: number[];
  nearest: number;
  /** The frame of the scan, empty if it has none. */
  frame: string;
}

interface Listener {
  robot: () => string;
  light: (lit: Lit[]) => void;
}

const KEY: unique symbol = Symbol.for("robowidgets lit") as never;

/** All listeners of the page. The scripts of different widgets share nothing else. */
const page = globalThis as { [KEY]?: Set<Listener> };

/** Lights rays in the pictures of a robot's scans, or, with an empty list, lights them no longer. */
export function light(robot: string, lit: Lit[]): void {
  for (const listener of page[KEY] ?? []) if (robot && listener.robot() === robot) listener.light(lit);
}

/** Calls back with the rays that are lit for a robot, until the signal aborts. */
export function onLight(robot: () => string, callback: (lit: Lit[]) => void, signal: AbortSignal): void {
  page[KEY] ??= new Set();
  const listener = { robot, light: callback };
  page[KEY].add(listener);
  onAbort(signal, () => page[KEY]?.delete(listener));
}
