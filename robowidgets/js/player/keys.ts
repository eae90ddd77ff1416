import { type Model, setTraits } from "../shared/model.ts";
import type { Playback } from "./playback.ts";
import type { PlayerTraits } from "./traits.ts";

/** Speeds of playing, in the list. */
export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10];

type Action = (playback: Playback, model: Model<PlayerTraits>) => void;

const jump =
  (seconds: number): Action =>
  (playback) =>
    playback.seek(playback.time + seconds);

function faster(by: -1 | 1): Action {
  return (_, model) => {
    const now = model.get("speed");
    const next = by > 0 ? SPEEDS.find((s) => s > now) : SPEEDS.filter((s) => s < now).at(-1);
    if (next !== undefined) setTraits(model, { speed: next });
  };
}

const ACTIONS: Record<string, Action> = {
  " ": (playback) => playback.toggle(),
  ",": (playback) => playback.step(-1),
  ".": (playback) => playback.step(1),
  n: (playback) => playback.toMark(1),
  p: (playback) => playback.toMark(-1),
  l: (_, model) => setTraits(model, { loop: !model.get("loop") }),
  "+": faster(1),
  "-": faster(-1),
  Home: (playback) => playback.seek(playback.begin),
  End: (playback) => playback.seek(playback.duration),
};

/** The action of a key; undefined without one. */
export function actionOf(key: string, shift: boolean): Action | undefined {
  const far = shift ? 10 : 1;
  if (key === "ArrowRight" || key === "ArrowUp") return jump(far);
  if (key === "ArrowLeft" || key === "ArrowDown") return jump(-far);
  return ACTIONS[key];
}

/** Returns true for a key that is for the bar only while the bar has the focus; elsewhere it scrolls the page. */
export function isBarsAlone(key: string): boolean {
  return key === "ArrowUp" || key === "ArrowDown";
}

/** Returns true if the focused element uses a key itself: lists and text fields all keys, buttons the space bar. */
export function usesItself(focused: HTMLElement, key: string): boolean {
  if (focused.isContentEditable || focused.matches("select, textarea, input:not([type=range])")) return true;
  return key === " " && focused.matches("button, a");
}
