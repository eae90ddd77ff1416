import { make, makeButton, makeIcon, set, setHidden } from "../shared/dom.ts";
import { on, onAbort } from "../shared/events.ts";
import { toFixed } from "../shared/format.ts";
import type { Mark } from "../shared/marks.ts";
import { lacksKernel, type Model, onChange, onMessage, setTraits } from "../shared/model.ts";
import { NameRow } from "../shared/naming.ts";
import type { Span } from "../shared/time_axis.ts";
import { keepChange } from "../shared/undo.ts";
import type { Playback } from "./playback.ts";
import type { PlayerTraits } from "./traits.ts";

const TAG = "M1 1h5l5.2 5.2-5 5L1 6z M3.2 2.3a.9.9 0 1 0 0 1.8.9.9 0 0 0 0-1.8z";
/** Milliseconds after which a kernel that has not answered is busy. */
const BUSY_MS = 700;

/** A request to the kernel: to keep the first, in exchange for the second. Either may be null. */
type Asked = [to: Mark | null, from: Mark | null];

/** The answer to a request; `stored` is the label that was kept, which may be longer than asked. */
interface Answer {
  labelled?: Asked;
  stored?: Mark | null;
  problem?: string;
}

/** A request that Ctrl+Z may undo. */
interface Kept {
  /** The label that the kernel stored; undefined before its answer. */
  stored?: Mark | null;
  isRefused: boolean;
  /** True if it is undone once the kernel has answered. */
  isUndone: boolean;
}

const isSame = (a: Asked, b: Asked) => JSON.stringify(a) === JSON.stringify(b);

/** Names of spans that the user gives: a row of them below the slider, and the controls to add and remove them. */
export class Labels {
  readonly button: HTMLButtonElement;
  readonly lane = make("div", "rw-play-labels");
  readonly row: NameRow;
  readonly #begun = make("span", "rw-play-begun");
  readonly #model: Model<PlayerTraits>;
  readonly #playback: Playback;
  readonly #redraw: () => void;
  readonly #signal: AbortSignal;
  /** Start of the span that will be named; null if none was begun. */
  #from: number | null = null;
  /** The span whose name the row asks for. */
  #span: Span = [0, 0];
  #old: Mark | null = null;
  /** Requests that the kernel has not answered yet. */
  #asked: Asked[] = [];
  readonly #kept = new WeakMap<Asked, Kept>();
  /** The labels in the lane, as text. */
  #shown = new Map<Element, string>();
  #isBusy = false;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #drawn: unknown[] = [];

  constructor(model: Model<PlayerTraits>, playback: Playback, redraw: () => void, signal: AbortSignal) {
    this.#model = model;
    this.#playback = playback;
    this.#redraw = redraw;
    this.#signal = signal;
    const about = "Give a name to the selected span, or to one from here to where you press it again (a)";
    this.button = makeButton("rw-label", about, () => this.press(), signal);
    this.button.append(makeIcon(TAG));
    const naming = {
      onName: (name: string) => this.#change([[...this.#span, name], this.#old]),
      onRemove: () => this.#remove(this.#old),
    };
    this.row = new NameRow("name of the span", naming, signal);
    this.row.root.classList.add("rw-play-naming");
    onChange(model, ["labels"], redraw, signal);
    onMessage(model, (answer: Answer) => this.#onAnswer(answer), signal);
    onAbort(signal, () => clearTimeout(this.#timer));
  }

  /** The text in the bar, or "". */
  get words(): string {
    const [to, from] = this.#asked[0] ?? [null, null];
    if (this.#isBusy && (to || from)) {
      return `\u201c${(to ?? from)?.[2]}\u201d ${to ? "is kept" : "goes"} when the running cell ends`;
    }
    return this.#from === null ? "" : `from ${toFixed(this.#from, 2)} s on: go to its end, press a`;
  }

  /** Names the selection, or the span from the previous press to here. */
  press(): void {
    if (this.row.isOpen) {
      this.row.close();
      return;
    }
    const [selection, now] = [this.#model.get("selection"), this.#playback.time];
    if (selection) this.#name([selection[0], selection[1]], null);
    else if (this.#from === null) this.#from = now;
    else this.#name([Math.min(this.#from, now), Math.max(this.#from, now)], null);
    this.#redraw();
  }

  /** Cancels a span that was begun; returns true if there was one. */
  cancel(): boolean {
    const isBegun = this.#from !== null;
    this.#from = null;
    if (isBegun) this.#redraw();
    return isBegun;
  }

  update(begin: number, duration: number): void {
    const hasKernel = !lacksKernel(this.#model);
    setHidden(this.button, !hasKernel);
    set(this.button, "ariaPressed", String(this.#from !== null));
    const place = (element: HTMLElement, [from, to]: Span) => {
      const part = (time: number) => `${(100 * (time - begin)) / (duration - begin)}%`;
      element.style.left = part(from);
      element.style.width = part(begin + to - from);
    };
    const now = this.#playback.shown;
    setHidden(this.#begun, this.#from === null);
    if (this.#from !== null) place(this.#begun, [Math.min(this.#from, now), Math.max(this.#from, now)]);
    const labels = this.#model.get("labels");
    setHidden(this.lane, !labels.length && !this.#asked.length && this.#from === null);
    // Compare by identity: this runs in every frame while it plays.
    const drawn = [labels, this.#asked, begin, duration, hasKernel];
    if (drawn.every((one, i) => one === this.#drawn[i])) return;
    this.#drawn = drawn;
    const gone = this.#asked.flatMap(([, from]) => (from ? [from.join()] : []));
    const coming = this.#asked.flatMap(([to]) => (to ? [to] : []));
    const shown = [...labels.filter((label) => !gone.includes(label.join())), ...coming];
    // Short ones lie on long ones.
    shown.sort(([a, b], [c, d]) => d - c - (b - a));
    const elements = shown.map((label) => {
      const element = this.#makeLabel(label, coming.includes(label) || !hasKernel);
      place(element, [label[0], label[1]]);
      return element;
    });
    // A label keeps the focus when it is drawn again.
    const focused = this.#shown.get(document.activeElement as Element);
    this.lane.replaceChildren(this.#begun, ...elements);
    this.#shown = new Map(elements.map((element, i) => [element, (shown[i] as Mark).join()]));
    if (focused) elements[shown.findIndex((label) => label.join() === focused)]?.focus({ preventScroll: true });
  }

  #makeLabel(label: Mark, isFixed: boolean): HTMLElement {
    const [start, end, name] = label;
    const element = make("button", "rw-play-label", name);
    element.type = "button";
    element.title = `\u201c${name}\u201d, ${toFixed(start, 2)} to ${toFixed(end, 2)} s`;
    element.classList.toggle(
      "rw-coming",
      this.#asked.some(([to]) => to === label),
    );
    const onClick = () => {
      this.#playback.seek(start);
      if (!isFixed) this.#name([start, end], label);
    };
    const onKey = (event: KeyboardEvent) => {
      if (isFixed || (event.key !== "Delete" && event.key !== "Backspace")) return;
      event.preventDefault();
      event.stopPropagation();
      this.#remove(label);
    };
    on(element, "click", onClick, this.#signal);
    on(element, "keydown", onKey, this.#signal);
    return element;
  }

  #name(span: Span, old: Mark | null, problem = "", typed = old?.[2] ?? ""): void {
    this.#span = span;
    this.#old = old;
    this.#from = null;
    const about = `${toFixed(span[0], 2)} to ${toFixed(span[1], 2)} s`;
    const known = this.#model.get("labels").map(([, , name]) => name);
    this.row.open(problem || about, old?.[2] ?? "", known, typed);
  }

  /** Its span is then selected, so that naming it again restores it. */
  #remove(label: Mark | null): void {
    if (!label) return;
    this.#change([null, label]);
    setTraits(this.#model, { selection: [label[0], label[1]] });
  }

  /** Asks for a change, and keeps it for Ctrl+Z in its turn, before the kernel has answered. */
  #change(asked: Asked): void {
    if (lacksKernel(this.#model)) return;
    const [to, from] = asked;
    const kept: Kept = { isRefused: false, isUndone: false };
    this.#kept.set(asked, kept);
    const undo = () => {
      kept.isUndone = true;
      if (kept.stored !== undefined) this.#ask([from, kept.stored]);
    };
    keepChange(this.lane, { words: `label “${(to ?? from)?.[2]}”`, undo, isRefused: () => kept.isRefused });
    this.#ask(asked);
  }

  #ask(asked: Asked): void {
    if (lacksKernel(this.#model)) return;
    const [to] = asked;
    const selection = this.#model.get("selection");
    if (to && selection?.[0] === to[0] && selection[1] === to[1]) setTraits(this.#model, { selection: null });
    this.#asked = [...this.#asked, asked];
    this.#model.send({ label: asked });
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => {
      this.#isBusy = this.#asked.length > 0;
      this.#redraw();
    }, BUSY_MS);
    this.#redraw();
  }

  #onAnswer({ labelled, stored, problem }: Answer): void {
    const of = labelled ? this.#asked.findIndex((asked) => isSame(asked, labelled)) : -1;
    const asked = this.#asked[of];
    if (!asked) return;
    this.#asked = this.#asked.filter((one) => one !== asked);
    this.#isBusy &&= this.#asked.length > 0;
    const [to, from] = asked;
    const span = to ?? from;
    // Nothing is lost: the typed text stands in the row again.
    if (problem && span && !this.row.isOpen) this.#name([span[0], span[1]], from, problem, (to ?? from)?.[2]);
    const kept = this.#kept.get(asked);
    if (kept) {
      kept.isRefused = Boolean(problem);
      kept.stored = stored ?? null;
      if (kept.isUndone && !kept.isRefused) this.#ask([from, kept.stored]);
    }
    this.#redraw();
  }
}
