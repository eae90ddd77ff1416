import { onAbort } from "../events.ts";
import { lacksKernel, type Model, onChange, onMessage } from "../model.ts";
import { Pulse } from "../pulse.ts";
import { BEAT_MS, KERNEL_BUSY_MS } from "../staleness.ts";
import type { DrivingTraits, Told } from "./traits.ts";

/** Milliseconds after which an unanswered heartbeat is lost. Until then no other is sent: a busy kernel queues them. */
const LOST_MS = 10_000;

/** Milliseconds that the kernel has to answer a Stop before it is interrupted. */
export const ANSWER_MS = 300;

/** Milliseconds that an interrupted cell has to end. */
export const END_MS = 2000;

/**
 * State of the last Stop or Allow of this page: "asking" until Python confirms the latch; "interrupted" after the
 * kernel was interrupted, "ignored" if it still does not answer; "unreachable" if the host has no way to interrupt a
 * busy kernel; "refused" if Allow came too late; else "".
 */
export type Note = "" | "asking" | "interrupted" | "ignored" | "unreachable" | "refused";

interface Kernel {
  interrupt?(): Promise<void>;
}

/** An answer of Python to the view of that name: a token for a beat, or the refusal of an Allow that came too late. */
interface Answer {
  beat?: string;
  token?: number;
  refused?: string;
}

/**
 * Stops the robot from a page. Stop is a message that sets a latch. When a running cell keeps the kernel from answering
 * in time, the page interrupts the kernel through the server, and the message is handled when the cell has ended.
 * Heartbeats show Python that the page is open, and the page that the kernel answers.
 */
export class StopControl {
  note: Note = "";
  readonly #model: Model<DrivingTraits>;
  readonly #name: string;
  readonly #tell: () => void;
  readonly #pulse: Pulse<DrivingTraits>;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #token = 0;
  #beatAt = Number.NEGATIVE_INFINITY;
  #isAnswered = true;
  #wasStopped = false;

  /**
   * @param name unique among the views of all pages
   * @param tell called when something has changed, and once a second
   */
  constructor(model: Model<DrivingTraits>, name: string, tell: () => void, signal: AbortSignal) {
    this.#model = model;
    this.#name = name;
    this.#tell = tell;
    this.#pulse = new Pulse(model, ["_state"], () => this.told.ready, tell, signal);
    const beats = setInterval(() => this.#beat(), BEAT_MS);
    onAbort(signal, () => {
      clearInterval(beats);
      clearTimeout(this.#timer);
    });
    onChange(model, ["_state"], () => this.#onState(), signal);
    onMessage(model, (answer: Answer) => this.#onAnswer(answer), signal);
    this.#wasStopped = this.told.stopped;
    this.#beat();
  }

  get told(): Told {
    return this.#model.get("_state");
  }

  /** True if Python can be reached from this page. */
  get hasKernel(): boolean {
    return !lacksKernel(this.#model);
  }

  /** True while the kernel answers this page. A busy kernel may not. */
  get hears(): boolean {
    return this.#isAnswered || performance.now() - this.#beatAt < KERNEL_BUSY_MS;
  }

  /** The time for which Python has been silent, or "" while the last state is current. */
  get silence(): string {
    return this.#pulse.words;
  }

  /** True if the page can interrupt the kernel. Only JupyterLab's widget manager gives access to it. */
  get canInterrupt(): boolean {
    return typeof this.#kernel?.interrupt === "function";
  }

  /** Stops the robot, and blocks driving until `allow`. */
  stop(): void {
    this.send({ act: "stop" });
    if (this.told.stopped) return;
    this.#turn("asking");
    this.#wait(ANSWER_MS, () => this.#interrupt());
  }

  /** Releases the latch. */
  allow(): void {
    this.#turn("");
    this.send({ act: "allow" });
  }

  #onAnswer({ beat, token, refused }: Answer): void {
    if (refused === this.#name) this.#turn("refused");
    if (beat !== this.#name) return;
    this.#token = token ?? 0;
    this.#isAnswered = true;
  }

  get #kernel(): Kernel | null | undefined {
    return (this.#model.widget_manager as { kernel?: Kernel | null } | undefined)?.kernel;
  }

  #onState(): void {
    const { stopped } = this.told;
    if (stopped) {
      clearTimeout(this.#timer);
      if (this.note === "ignored") this.note = "interrupted";
      else if (this.note !== "interrupted" && this.note !== "refused") this.note = "";
    } else if (this.#wasStopped) this.note = "";
    this.#wasStopped = stopped;
    // Browsers slow down the timers of a hidden page, but not its messages: send heartbeats on those too.
    if (performance.now() - this.#beatAt > 0.9 * BEAT_MS) this.#beat();
    else this.#tell();
  }

  #beat(): void {
    if (this.#isAnswered || performance.now() - this.#beatAt > LOST_MS) {
      this.#beatAt = performance.now();
      this.#isAnswered = false;
      this.send({ act: "beat" });
    }
    this.#tell();
  }

  async #interrupt(): Promise<void> {
    // A broken network keeps the request waiting for minutes.
    this.#wait(END_MS, () => this.#turn("unreachable"));
    try {
      if (!this.canInterrupt) throw new Error("no kernel");
      await this.#kernel?.interrupt?.();
    } catch {
      clearTimeout(this.#timer);
      return this.told.stopped ? undefined : this.#turn("unreachable");
    }
    this.#turn("interrupted");
    if (!this.told.stopped) this.#wait(END_MS, () => this.#turn("ignored"));
  }

  #wait(ms: number, then: () => void): void {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(then, ms);
  }

  #turn(note: Note): void {
    this.note = note;
    this.#tell();
  }

  /** Sends a message with the newest token, which shows Python the age of the message. */
  send(message: object): void {
    try {
      this.#model.send({ ...message, press: this.#name, token: this.#token });
    } catch {
      // The kernel of this widget is gone. Its missing answers are handled elsewhere.
    }
  }
}
