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

/** A ray at which the user points in a picture of a robot's scan, or that is pinned there. */
export interface PointedRay {
  index: number;
  /** The frame of the scan, empty if it has none. */
  frame: string;
}

interface Pointed {
  /** The rays of each picture, with the robot of the picture. */
  rays: Map<object, { robot: string; rays: PointedRay[] }>;
  listeners: Set<() => void>;
}

const KEY: unique symbol = Symbol.for("robowidgets lit") as never;
const POINTED: unique symbol = Symbol.for("robowidgets pointed rays") as never;

/** All listeners of the page. The scripts of different widgets share nothing else. */
const page = globalThis as { [KEY]?: Set<Listener>; [POINTED]?: Pointed };

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

function pointed(): Pointed {
  page[POINTED] ??= { rays: new Map(), listeners: new Set() };
  return page[POINTED];
}

/** Notes the rays at which the user points in a picture; an empty list if there are none. */
export function pointAtRays(picture: object, robot: string, rays: PointedRay[]): void {
  const { rays: known, listeners } = pointed();
  if (rays.length) known.set(picture, { robot, rays });
  else if (!known.delete(picture)) return;
  for (const listener of listeners) listener();
}

/** Returns the rays at which the user points in the pictures of a robot. */
export function pointedRays(robot: string): PointedRay[] {
  return [...pointed().rays.values()].flatMap((one) => (robot && one.robot === robot ? one.rays : []));
}

/** Calls back when the user points at another ray, until the signal aborts. */
export function onPointedRays(callback: () => void, signal: AbortSignal): void {
  pointed().listeners.add(callback);
  onAbort(signal, () => pointed().listeners.delete(callback));
}

/** Returns true if a line read one of some rays. */
export function readsOne(lit: Lit[], rays: PointedRay[]): boolean {
  return lit.some(({ runs, frame }) =>
    rays.some(
      (ray) =>
        (!frame || !ray.frame || frame === ray.frame) &&
        runs.some((first, i) => i % 2 === 0 && first <= ray.index && ray.index < (runs[i + 1] ?? first)),
    ),
  );
}
