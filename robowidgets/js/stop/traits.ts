import type { NamedTraits } from "../shared/traits.ts";

export interface StopTraits extends NamedTraits {
  _state: Told;
}

/** What Python tells: who drives, the speed sent last, whether stop is latched, and texts. */
export interface Told {
  ready: boolean;
  /** "program", the name of a press, or nobody. */
  driver: string;
  speed: [number, number];
  stopped: boolean;
  error: string;
  cause: string;
  words: string;
  topic: string;
  /** Counts what was told, so that the same is news again. */
  number: number;
}
