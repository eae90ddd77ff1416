import type { Point } from "../shared/box.ts";
import type { PopupWords } from "../shared/popup.ts";
import { firstWhere } from "../shared/search.ts";
import { stateAt } from "../shared/states/states.ts";
import { toTime } from "../shared/time_axis.ts";
import type { NamedSpan, Whole } from "./data.ts";
import type { Band } from "./layout.ts";
import type { Pointed, Scene } from "./scene.ts";
import type { State } from "./state.ts";
import { describeMark, describePlace, describeSpeed, describeState, describeTouches, describeUnread } from "./text.ts";

/** The thing under the pointer, its place, and the text of its pop-up; null if there is none. */
export function pointAt(point: Point, scene: Scene, state: State): (Pointed & { y: number; words: PopupWords }) | null {
  const { whole, blocks } = state;
  const { left, width, scans, speeds, touch, states } = scene.layout;
  if (!whole || !blocks || point.x < left || point.x >= left + width) return null;
  const time = toTime(scene.axis, point.x);
  const perPixel = (scene.axis.span[1] - scene.axis.span[0]) / width;
  const isIn = ({ top, height }: Band) => point.y >= top && point.y < top + height;
  if (isIn(scans)) {
    const row = scene.toRow(point.y);
    const ray = scene.rows.rayOf[row] ?? 0;
    const angle = scene.rows.angles[row] ?? 0;
    const isThinned = whole.driveScans !== undefined;
    const place = blocks.at(time, ray) ?? (isThinned ? blocks.near(time, ray, perPixel / 2) : null);
    if (!place && isThinned) return { time, row: null, y: point.y, words: describeUnread(time) };
    return place && { time, row, y: scene.toY(row), words: describePlace(place, angle, whole.sweep, whole.pixel) };
  }
  const axis = speeds.findIndex(isIn);
  const beside = (words: PopupWords | null | undefined, y = point.y) => (words ? { time, row: null, y, words } : null);
  if (axis >= 0) return beside(speedAt(whole, state, axis, time));
  if (touch && isIn(touch)) {
    return beside(whole.touch && describeTouches(near(whole.touch.spans, time, perPixel), whole.touch.title, time));
  }
  const row = states.findIndex(isIn);
  if (row >= 0) {
    const active = stateAt(state.states[row] ?? [], time);
    return beside(active && describeState(active));
  }
  // Its pop-up keeps off the other marks.
  const isAbove = point.y < scans.top;
  return beside(isAbove ? near(state.marks, time, perPixel).map(describeMark)[0] : null, scans.top + scans.height / 2);
}

function speedAt({ speed }: Whole, { blocks, view }: State, axis: number, time: number): PopupWords | null {
  const speeds = blocks?.speedsIn(view);
  if (!speed || !speeds) return null;
  const at = firstWhere(speeds.startsAt, (start) => start > time) - 1;
  const [low, high, start] = [speeds.least[axis]?.[at], speeds.greatest[axis]?.[at], speeds.startsAt[at]];
  if (low === undefined || high === undefined || start === undefined) return null;
  return describeSpeed(speed.axes[axis] ?? "", speed.title, low, high, start);
}

/** Spans at a time, with a pixel or two of tolerance: short spans are drawn wider than they are. */
function near(spans: NamedSpan[], time: number, perPixel: number): NamedSpan[] {
  const close = 2 * perPixel;
  return spans.filter(({ start, end }) => time >= start - close && time <= end + close);
}
