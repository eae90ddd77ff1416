import { PRESS_SILENT_MS } from "../shared/staleness.ts";
import { CENTER, type Knob } from "./knob.ts";

/** A message of the pad to Python. */
export interface PadMessage extends Partial<Knob> {
  act: "press" | "hold" | "release";
  press: string;
  token?: number;
}

/** An answer of Python: a token that the next message carries back, or the reason why the press is over. */
export interface Answer {
  press: string;
  token?: number;
  over?: State;
}

/** Milliseconds between two messages of a press. */
export const BEAT_MS = 100;

/** Least milliseconds between two messages while the knob moves. */
const SOONEST_MS = 40;

/**
 * State of the pad: "free"; "asking" or "driving" while held; "silent" when Python does not answer, "late" when it
 * answered after all; or the reason that Python gave for ending a press that is still held.
 */
export type State =
  | "free"
  | "asking"
  | "driving"
  | "silent"
  | "late"
  | "nothing"
  | "disabled"
  | "stopped"
  | "hangs"
  | "failed"
  | "taken"
  | "released";

/**
 * Sends the presses of a pad. While the pad is held, Python gets the position of the knob ten times a second, as long
 * as it answers. After half a second without an answer the press has ended: the user must release and press again.
 */
export class PressLease {
  state: State = "free";
  readonly #name: string;
  readonly #send: (message: PadMessage) => void;
  readonly #tell: () => void;
  #count = 0;
  #token = 0;
  #heard = 0;
  #said = 0;
  #knob = CENTER;
  #beat: ReturnType<typeof setInterval> | undefined;

  /**
   * @param name unique among the pads of all pages
   * @param tell called when the state has changed
   */
  constructor(name: string, send: (message: PadMessage) => void, tell: () => void) {
    this.#name = name;
    this.#send = send;
    this.#tell = tell;
  }

  /** The name of this press, or of the last one. */
  get press(): string {
    return `${this.#name}-${this.#count}`;
  }

  get held(): boolean {
    return this.#beat !== undefined;
  }

  /** Holds the pad with the knob at a place, or moves the knob. */
  hold(knob: Knob): void {
    this.#knob = knob;
    if (this.held) {
      if (this.state === "driving" && performance.now() - this.#said >= SOONEST_MS) this.#say();
      return;
    }
    this.#count++;
    this.#heard = performance.now();
    this.#beat = setInterval(() => this.#onBeat(), BEAT_MS);
    this.#turn("asking");
    this.#post({ act: "press", press: this.press });
  }

  /** Releases the pad; the robot stops. */
  release(): void {
    if (!this.held) return;
    clearInterval(this.#beat);
    this.#beat = undefined;
    this.#knob = CENTER;
    // Without an answer it is unknown whether Python got the release.
    if (this.state !== "silent") this.#turn("free");
    this.#post({ act: "release", press: this.press });
  }

  onAnswer({ press, token, over }: Answer): void {
    if (press !== this.press) return;
    if (!this.held) {
      if (over) this.#turn("free");
    } else if (this.state === "silent") this.#turn("late");
    else if (this.#goes && over) this.#turn(over);
    else if (this.#goes && token) this.#onToken(token);
  }

  /** True while the press that is held is not over. */
  get #goes(): boolean {
    return this.state === "asking" || this.state === "driving";
  }

  #onToken(token: number): void {
    this.#heard = performance.now();
    this.#token = token;
    if (this.state === "driving") return;
    this.#turn("driving");
    this.#say();
  }

  #onBeat(): void {
    if (!this.#goes) return;
    if (performance.now() - this.#heard > PRESS_SILENT_MS) {
      this.#turn("silent");
      this.#post({ act: "release", press: this.press });
    } else if (this.state === "driving") this.#say();
  }

  #say(): void {
    this.#said = performance.now();
    this.#post({ act: "hold", press: this.press, token: this.#token, ...this.#knob });
  }

  #post(message: PadMessage): void {
    try {
      this.#send(message);
    } catch {
      // The kernel of this pad is gone.
      this.#turn("silent");
    }
  }

  #turn(state: State): void {
    if (state === this.state) return;
    this.state = state;
    this.#tell();
  }
}
