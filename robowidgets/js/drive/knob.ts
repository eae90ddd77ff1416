/** Positions of the knobs: shares of the limits within ±1, positive ahead and to the left. */
export interface Knob {
  forward: number;
  turn: number;
  lateral: number;
}

export const CENTER: Knob = { forward: 0, turn: 0, lateral: 0 };

/** Dead zone around the centre, as a share of the way to the edge, for driving straight. */
const SLACK = 0.06;

const clamp = (value: number) => Math.max(-1, Math.min(1, value));

function toShare(value: number): number {
  const share = clamp(value);
  return Math.sign(share) * Math.max(0, (Math.abs(share) - SLACK) / (1 - SLACK)) || 0;
}

/** The knob under a pointer, from pixels right of and below the middle of a pad that reaches so many pixels. */
export function toKnob(right: number, below: number, reach: number): Pick<Knob, "forward" | "turn"> {
  return { forward: toShare(-below / reach), turn: toShare(-right / reach) };
}

/** The knob for sideways under a pointer, from pixels right of the middle of a slide that reaches so many pixels. */
export function toSlide(right: number, reach: number): Pick<Knob, "lateral"> {
  return { lateral: toShare(-right / reach) };
}

/** Positions of the drawn knobs: shares of the reach, right of and below the middle. */
export function toPlace({ forward, turn, lateral }: Knob): { right: number; below: number; slide: number } {
  const out = (share: number) => Math.sign(share) * (Math.abs(share) * (1 - SLACK) + SLACK);
  return { right: -out(turn), below: -out(forward), slide: -out(lateral) };
}

const KEYS: Record<string, Partial<Knob>> = {
  ArrowUp: { forward: 1 },
  ArrowDown: { forward: -1 },
  ArrowLeft: { turn: 1 },
  ArrowRight: { turn: -1 },
  KeyW: { forward: 1 },
  KeyS: { forward: -1 },
  KeyA: { turn: 1 },
  KeyD: { turn: -1 },
  KeyQ: { lateral: 1 },
  KeyE: { lateral: -1 },
};

/**
 * Returns true if a key drives the robot. Keys are named by their position, so that W, A, S, D are in the same places
 * on any keyboard.
 */
export function isDriving(code: string, sideways: boolean): boolean {
  const knob = KEYS[code];
  return knob !== undefined && (sideways || !knob.lateral);
}

/** The knobs of the keys that are held: at the limits, and in the middle between opposite ones. */
export function ofKeys(held: Iterable<string>): Knob {
  const sum = { ...CENTER };
  for (const code of held) {
    for (const [axis, share] of Object.entries(KEYS[code] ?? {})) sum[axis as keyof Knob] += share;
  }
  return { forward: clamp(sum.forward), turn: clamp(sum.turn), lateral: clamp(sum.lateral) };
}
