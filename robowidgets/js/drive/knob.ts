/** Where the knob is: shares of the limits within ±1, ahead and to the left above 0. */
export interface Knob {
  forward: number;
  turn: number;
}

export const CENTER: Knob = { forward: 0, turn: 0 };

/** Dead zone around the centre, as a share of the way to the edge, so that a person can drive straight. */
const SLACK = 0.06;

const clamp = (value: number) => Math.max(-1, Math.min(1, value));

function toShare(value: number): number {
  const share = clamp(value);
  return Math.sign(share) * Math.max(0, (Math.abs(share) - SLACK) / (1 - SLACK)) || 0;
}

/** The knob under a pointer, from pixels right of and below the middle of a pad that reaches so many pixels. */
export function toKnob(right: number, below: number, reach: number): Knob {
  return { forward: toShare(-below / reach), turn: toShare(-right / reach) };
}

/** Where the knob is drawn: shares of the reach, right of and below the middle. */
export function toPlace({ forward, turn }: Knob): { right: number; below: number } {
  const out = (share: number) => Math.sign(share) * (Math.abs(share) * (1 - SLACK) + SLACK);
  return { right: -out(turn), below: -out(forward) };
}

const KEYS: Record<string, Knob> = {
  ArrowUp: { forward: 1, turn: 0 },
  ArrowDown: { forward: -1, turn: 0 },
  ArrowLeft: { forward: 0, turn: 1 },
  ArrowRight: { forward: 0, turn: -1 },
  KeyW: { forward: 1, turn: 0 },
  KeyS: { forward: -1, turn: 0 },
  KeyA: { forward: 0, turn: 1 },
  KeyD: { forward: 0, turn: -1 },
};

/** Whether a key drives. Keys are named by their place, so that W, A, S, D are where they are on any keyboard. */
export function isDriving(code: string): boolean {
  return code in KEYS;
}

/** The knob of the keys that are held: at the limits, and in the middle between opposite ones. */
export function ofKeys(held: Iterable<string>): Knob {
  let [forward, turn] = [0, 0];
  for (const code of held) {
    forward += KEYS[code]?.forward ?? 0;
    turn += KEYS[code]?.turn ?? 0;
  }
  return { forward: clamp(forward), turn: clamp(turn) };
}
