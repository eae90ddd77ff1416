import { FARTHEST_VIEW } from "./frames/scan.ts";
import { watchWheel } from "./wheel.ts";

const CLOSEST = 0.05;
const WHEEL_STEP = 40;

/** Actions of the wheel and of the keys + and -. */
export interface Zoom {
  onZoom(direction: -1 | 1): void;
  /** Returns true if it can zoom further; else the wheel scrolls the page. */
  canZoom(direction: -1 | 1): boolean;
}

/** The direction in which a key zooms. */
export const ZOOM_KEYS: Record<string, -1 | 1> = { "+": -1, "=": -1, "-": 1, _: 1 };

const NUDGE = 40;

/** The pixels by which an arrow key moves the picture: the right arrow moves the drawing to the left. */
export const MOVE_KEYS: Record<string, [x: number, y: number]> = {
  ArrowRight: [-NUDGE, 0],
  ArrowLeft: [NUDGE, 0],
  ArrowUp: [0, NUDGE],
  ArrowDown: [0, -NUDGE],
};

/** Round numbers of metres, from 1 cm to 800 km. */
const ROUND = [-2, -1, 0, 1, 2, 3, 4, 5].flatMap((power) =>
  [1, 1.5, 2, 2.5, 3, 4, 5, 6, 8].map((step) => Number(`${step}e${power}`)),
);

/** The smallest round number of metres that is at least this. */
export function roundUp(metres: number): number {
  return ROUND.find((round) => round >= metres * (1 - 1e-9)) ?? metres;
}

/** One step nearer (-1) or farther (+1) in round numbers, and farther only within the range of the sensor. */
export function stepRange(metres: number, direction: -1 | 1, maxRange: number): number {
  if (direction > 0) return Math.max(metres, Math.min(maxRange, FARTHEST_VIEW, roundUp(metres * 1.01)));
  return Math.max(CLOSEST, ROUND.filter((round) => round <= metres * 0.99).at(-1) ?? 0);
}

/** Zooms by the wheel, a step for each notch. */
export function watchZoom(element: HTMLElement, zoom: Zoom, signal: AbortSignal): void {
  let turned = 0;
  const onWheel = (event: WheelEvent): boolean => {
    if (!event.deltaY) return false;
    const direction = event.deltaY < 0 ? -1 : 1;
    turned += event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 20 : 1);
    if (Math.abs(turned) >= WHEEL_STEP) {
      zoom.onZoom(direction);
      turned = 0;
    }
    return zoom.canZoom(direction);
  };
  watchWheel(element, onWheel, signal);
}
