import type { Pose } from "../shared/floor.ts";
import { type Model, onMessage } from "../shared/model.ts";
import { type Scene, type Thing, withoutObstacle, withThing } from "./scene.ts";
import type { SimulatorTraits } from "./traits.ts";

/** A request of the page to Python. */
type Edit =
  | { act: "robot"; x: number; y: number; yaw: number }
  | { act: "put"; x: number; y: number }
  | { act: "move"; index: number; x: number; y: number }
  | { act: "remove"; index: number }
  | { act: "reset" };

/** Python's answer: the name of the edit, or null if it had none, and the reason for a refusal, or "" if it was made. */
interface Answer {
  edit: string | null;
  refused: string;
}

/** Milliseconds between two messages of a drag. */
const SPACING_MS = 50;

/**
 * Edits of the page that Python has not made yet. The picture shows them until Python has answered, which a busy kernel
 * may do late, and has sent the result.
 */
export class Edits {
  readonly #model: Model<SimulatorTraits>;
  readonly #name: string;
  readonly #onRefused: (why: string) => void;
  #count = 0;
  #sentAt = 0;
  #waiting: { thing: Thing; pose: Pose } | null = null;
  #isAnswered = false;
  /** The removals that are not made yet, with the numbers of their edits; an index counts without the earlier ones. */
  #removed: { index: number; edit: number }[] = [];
  /** The number of the last edit that was answered. */
  #answered = 0;

  /** @param name unique among the views of all pages */
  constructor(model: Model<SimulatorTraits>, name: string, onRefused: (why: string) => void, signal: AbortSignal) {
    this.#model = model;
    this.#name = name;
    this.#onRefused = onRefused;
    onMessage(model, (answer: Answer) => this.#onAnswer(answer), signal);
  }

  /** The thing that is shown at another place than Python's. */
  get thing(): Thing | null {
    return this.#waiting?.thing ?? null;
  }

  /** The scene with the edits of the user. */
  apply(scene: Scene): Scene {
    const left = this.#removed.reduce((scene, { index }) => withoutObstacle(scene, index), scene);
    return this.#waiting ? withThing(left, this.#waiting.thing, this.#waiting.pose) : left;
  }

  /** Moves a thing. Only some places of a drag are sent, but always the last one. */
  move(thing: Thing, pose: Pose, isDrag = false): void {
    this.#waiting = { thing, pose };
    this.#isAnswered = false;
    if (isDrag && performance.now() - this.#sentAt < SPACING_MS) return;
    const { x, y, yaw } = pose;
    this.send(typeof thing === "number" ? { act: "move", index: thing, x, y } : { act: "robot", x, y, yaw });
  }

  /** Removes an obstacle. */
  remove(index: number): void {
    const thing = this.#waiting?.thing;
    if (thing === index) this.#waiting = null;
    else if (this.#waiting && typeof thing === "number" && thing > index) this.#waiting.thing = thing - 1;
    this.#removed.push({ index, edit: this.#count + 1 });
    this.send({ act: "remove", index });
  }

  send(edit: Edit): void {
    this.#sentAt = performance.now();
    this.#count++;
    try {
      this.#model.send({ ...edit, edit: `${this.#name}-${this.#count}` });
    } catch {
      this.#waiting = null;
      this.#removed = [];
      this.#onRefused("the kernel is gone");
    }
  }

  /** Called with each frame of Python. */
  onFrame(): void {
    this.#removed = this.#removed.filter(({ edit }) => edit > this.#answered);
    if (this.#isAnswered) this.#waiting = null;
  }

  #onAnswer({ edit, refused }: Answer): void {
    const [name, number] = edit?.split("-") ?? [];
    if (name !== this.#name) return;
    this.#answered = Number(number);
    if (refused) this.#removed = this.#removed.filter(({ edit }) => edit !== this.#answered);
    if (this.#answered !== this.#count) return;
    this.#isAnswered = true;
    if (!refused) return;
    this.#waiting = null;
    this.#onRefused(refused);
  }
}
