import { make, makeButton, set, setHidden, setText } from "./dom.ts";
import { on } from "./events.ts";
import { toAge } from "./format.ts";
import type { Texts } from "./schedule.ts";
import { type Frame, type Stream, sequenceOf } from "./stream.ts";
import type { About, Lamp } from "./traits.ts";

/** Lamps that are unfolded at once; the others are names. */
const MOST_OPEN = 3;

/** The lamps of a sample: without verdicts on this very sample, every lamp is unknown. */
export function lampsOf(about: About, sequence: number | undefined, isStale = false): Lamp[] {
  const lamps = about.lamps ?? [];
  if (about.judged === sequence && !isStale) return lamps;
  return lamps.map((lamp) => (lamp.state === "off" ? lamp : { ...lamp, state: "unknown", text: "", rays: [] }));
}

/**
 * The place of the last change before (-1) or of the first after (1) a place in a list of states; -1 without a change.
 * Unknown states are skipped.
 */
export function changeFrom(states: string[], place: number, direction: -1 | 1): number {
  const known = states.flatMap((state, i) => (state === "true" || state === "false" ? [i] : []));
  const changes = known.filter((index, i) => i > 0 && states[index] !== states[known[i - 1] as number]);
  const found = direction < 0 ? changes.filter((i) => i < place).at(-1) : changes.find((i) => i > place);
  return found ?? -1;
}

/** The state of a lamp in words, with the seconds for which it has lasted. */
export function stateWords({ state, since }: Lamp, arrived: number): [word: string, time: string] {
  if (state === "off") return ["off", ""];
  if (state === "unknown" || since === null) return [state, ""];
  return [state, ` for ${toAge(1000 * Math.max(0, arrived - since))}`];
}

/** The elements of one lamp. */
class Row {
  readonly name: HTMLButtonElement;
  readonly elements: HTMLElement[];
  readonly #state = make("b", "");
  readonly #time = make("span", "");
  readonly #words = make("span", "rw-lamp-words");
  readonly #text = make("span", "rw-lamp-text");
  readonly #count = make("span", "rw-lamp-count");
  readonly #changes = make("span", "rw-lamp-changes");
  readonly #texts: Texts;
  #shown: { lamp: Lamp; arrived: number; isOpen: boolean } | null = null;

  constructor(
    name: string,
    onName: () => void,
    onStep: (direction: -1 | 1) => void,
    texts: Texts,
    signal: AbortSignal,
  ) {
    this.name = makeButton("rw-lamp", "", onName, signal, name);
    this.#words.append(this.#state, this.#time);
    const back = makeButton("rw-step", `${name}: the change before`, () => onStep(-1), signal, "\u2039");
    const next = makeButton("rw-step", `${name}: the next change`, () => onStep(1), signal, "\u203a");
    this.#changes.append(back, this.#count, next);
    this.elements = [this.name, this.#words, this.#text, this.#changes];
    this.#texts = texts;
  }

  /** @param isFrozen true while its numbers stand still: they are shown at once then, just as a change of state */
  draw(lamp: Lamp, arrived: number, isOpen: boolean, isFrozen: boolean): void {
    const isNew = this.#shown?.lamp.state !== lamp.state;
    this.#shown = { lamp, arrived, isOpen };
    set(this.name.dataset, "rwState", lamp.state);
    for (const element of this.elements.slice(1)) setHidden(element, !isOpen);
    this.#changes.style.visibility = lamp.changes ? "" : "hidden";
    if (isNew || isFrozen) this.#write();
    else this.#texts.ask(this.#write);
  }

  readonly #write = (): void => {
    if (!this.#shown) return;
    const { lamp, arrived, isOpen } = this.#shown;
    const [word, time] = stateWords(lamp, arrived);
    setText(this.#state, word);
    setText(this.#time, time);
    setText(this.#text, lamp.text);
    setText(this.#count, `${lamp.changes} change${lamp.changes === 1 ? "" : "s"}`);
    set(this.name, "title", [`${lamp.name} is ${word}${time}`, lamp.text].filter(Boolean).join("\n"));
    set(this.name, "ariaLabel", `${lamp.name}: ${word}`);
    set(this.name, "ariaExpanded", String(isOpen));
  };
}

/** The card of the lamps. */
interface LampCard {
  readonly texts: Texts;
  /** True while the present is unknown. */
  readonly isStale: boolean;
  /** Announces words to a screen reader. */
  say(words: string[]): void;
}

/** The conditions that Python judges on each sample: a lamp for each, below the picture. */
export class Lamps {
  readonly root = make("div", "rw-lamps");
  readonly #stream: Stream<Frame>;
  readonly #card: LampCard;
  readonly #signal: AbortSignal;
  #rows = new Map<string, Row>();
  #states = new Map<string, string>();
  /** Names of the unfolded lamps, the last chosen first; the user may have folded others. */
  #open: string[] = [];

  constructor(stream: Stream<Frame>, card: LampCard, signal: AbortSignal) {
    this.#stream = stream;
    this.#card = card;
    this.#signal = signal;
    this.root.role = "group";
    this.root.ariaLabel = "conditions";
    this.root.hidden = true;
    // Keys that a button uses itself must not move through the picture.
    on(this.root, "keydown", (event) => /^(Enter| )$/.test(event.key) && event.stopPropagation(), signal);
  }

  /** The lamps on show: unknown while the source is silent. */
  get verdicts(): Lamp[] {
    const { shown, about, paused } = this.#stream;
    return lampsOf(about, shown?.sequence, !paused && this.#card.isStale);
  }

  update(): void {
    const { shown, paused } = this.#stream;
    const lamps = this.verdicts;
    setHidden(this.root, !lamps.length);
    if (!lamps.length && !this.#rows.size) return;
    if (lamps.map(({ name }) => name).join("\n") !== [...this.#rows.keys()].join("\n")) this.#arrange(lamps);
    for (const lamp of lamps) {
      this.#rows.get(lamp.name)?.draw(lamp, shown?.arrived ?? 0, this.#open.includes(lamp.name), paused);
      this.#tell(lamp);
    }
  }

  /** Announces a change of a watched lamp to a screen reader. */
  #tell({ name, state }: Lamp): void {
    const before = this.#states.get(name);
    this.#states.set(name, state);
    if (before && before !== state && state !== "unknown" && !this.#stream.paused) this.#card.say([`${name} ${state}`]);
  }

  #arrange(lamps: Lamp[]): void {
    const before = this.#rows;
    const names = lamps.map(({ name }) => name);
    this.#rows = new Map(names.map((name) => [name, before.get(name) ?? this.#makeRow(name)]));
    const added = names.filter((name) => !before.has(name));
    this.#open = [...this.#open.filter((name) => names.includes(name)), ...added].slice(0, MOST_OPEN);
    this.#place();
  }

  #makeRow(name: string): Row {
    return new Row(
      name,
      () => this.#toggle(name),
      (direction) => this.#step(name, direction),
      this.#card.texts,
      this.#signal,
    );
  }

  /** Gives each unfolded lamp a line; the names of the others share one. */
  #place(): void {
    const rest = make("div", "rw-lamps-rest");
    this.root.replaceChildren();
    for (const [name, row] of this.#rows) {
      row.name.classList.toggle("rw-lamp-chosen", this.#open[0] === name);
      if (this.#open.includes(name)) this.root.append(...row.elements);
      else rest.append(...row.elements);
    }
    if (rest.childElementCount) this.root.append(rest);
  }

  #toggle(name: string): void {
    const others = this.#open.filter((other) => other !== name);
    // In a narrow card only the chosen lamp is unfolded: a click on another one chooses it.
    const isFolded = !this.#open.includes(name) || this.#open[0] !== name;
    this.#open = isFolded ? [name, ...others].slice(0, MOST_OPEN) : others;
    this.#place();
    this.update();
    this.#rows.get(name)?.name.focus({ preventScroll: true });
  }

  /** Freezes the picture at the change of a lamp before or after the sample on show. */
  #step(name: string, direction: -1 | 1): void {
    const states = this.#stream.moments.map(({ about, bytes }) => {
      return lampsOf(about, sequenceOf(bytes)).find((lamp) => lamp.name === name)?.state ?? "unknown";
    });
    const place = this.#stream.paused ? (this.#stream.place?.index ?? 0) : states.length;
    const found = changeFrom(states, place, direction);
    if (found < 0) {
      this.#card.say([`no ${direction < 0 ? "earlier" : "later"} change of ${name} is kept here`]);
      return;
    }
    if (!this.#stream.paused) this.#stream.toggle();
    this.#stream.seek(found);
  }
}
