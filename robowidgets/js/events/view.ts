import { make, pointIn, setHidden, setText } from "../shared/dom.ts";
import { isPlain, on, onAbort } from "../shared/events.ts";
import { toCount } from "../shared/format.ts";
import { type Model, onChange, setTraits } from "../shared/model.ts";
import { SampleCard } from "../shared/sample_card.ts";
import { throttle } from "../shared/schedule.ts";
import type { Stream } from "../shared/stream.ts";
import { type Span, toTime } from "../shared/time_axis.ts";
import type { Pointing } from "../shared/traits.ts";
import { AXIS, AxisView } from "./axis.ts";
import { List } from "./list.ts";
import { type EventsFrame, LEVELS, type Row, Rows, rowAt } from "./rows.ts";
import { countLevels, type Times, toExtent, toSpoken } from "./text.ts";
import type { EventsAbout, EventsTraits, LevelName } from "./traits.ts";

const WALK: Record<string, number> = {
  ArrowDown: 1,
  ArrowUp: -1,
  PageDown: 10,
  PageUp: -10,
  Home: -Infinity,
  End: Infinity,
};
const LEAST: Record<LevelName, string> = {
  DEBUG: "all levels",
  INFO: "info and up",
  WARN: "warnings",
  ERROR: "errors",
  FATAL: "fatal alone",
};
/** Least milliseconds between two rows for a screen reader. */
const SAY_MS = 1000;

type Traits = EventsTraits & Pointing;

/** One view of an events widget: it wires the card, the axis, the list, the filter and the keys. */
export class EventsView {
  readonly #model: Model<Traits>;
  readonly #stream: Stream<EventsFrame>;
  readonly #card: SampleCard;
  readonly #axis = new AxisView();
  readonly #list: List;
  readonly #empty = make("div", "rw-empty");
  readonly #level = make("select", "rw-button rw-events-level");
  readonly #words = make("input", "rw-field rw-events-words");
  readonly #errors = make("b", "rw-events-errors");
  readonly #warnings = make("b", "rw-events-warnings");
  readonly #others = make("span", "");
  readonly #extent = make("span", "rw-events-extent");
  readonly #rows = new Rows();
  readonly #sayNew: () => void;
  #shown: Row[] = [];
  /** Number of the row that the user picked, and of the unfolded row. */
  #picked: number | null = null;
  #open: number | null = null;
  /** The row under the pointer, and the time under it while it is on the axis. */
  #hovered: number | null = null;
  /** The number of the first row that was not announced. */
  #said = Infinity;
  #frozen: Row[] | null = null;

  constructor(model: Model<Traits>, element: HTMLElement, stream: Stream<EventsFrame>, signal: AbortSignal) {
    this.#model = model;
    this.#stream = stream;
    this.#card = new SampleCard(element, "events", model, stream, () => this.#draw(), signal);
    const { picture, footer, root } = this.#card;
    // Screen readers leave the arrow keys to it.
    picture.role = "application";
    picture.ariaLabel = "list of events";
    this.#list = new List(
      (row) => this.#onPick(row),
      (row) => this.#point(row?.seconds ?? null),
      signal,
    );
    const body = make("div", "rw-events-body");
    body.append(this.#axis.root, this.#list.root);
    picture.append(body, this.#empty);
    this.#makeFilter(signal);
    const counts = make("span", "rw-events-counts");
    counts.append(this.#errors, this.#warnings, this.#others);
    footer.append(counts, this.#extent);
    this.#sayNew = throttle(() => this.#say(), SAY_MS, signal);
    onChange(model, ["_old", "_new", "_span", "_start", "level", "words", "time"], this.#card.redraw, signal);
    const axis = this.#axis.root;
    on(axis, "pointermove", (event) => event.pointerType !== "touch" && this.#point(this.#timeAt(event)), signal);
    on(axis, "pointerleave", () => this.#point(null), signal);
    on(axis, "click", (event) => this.#goTo(this.#timeAt(event)), signal);
    on(root, "keydown", (event) => this.#onKey(event), signal);
    onAbort(signal, () => this.#point(null));
  }

  #makeFilter(signal: AbortSignal): void {
    this.#level.title = "The least level that is listed";
    this.#level.ariaLabel = this.#level.title;
    this.#level.append(...LEVELS.map(({ name }) => new Option(LEAST[name], name)));
    on(
      this.#level,
      "change",
      () => setTraits(this.#model, { level: this.#level.value as LevelName } as Partial<Traits>),
      signal,
    );
    const words = this.#words;
    words.type = "search";
    words.placeholder = "filter ( / )";
    words.title = "Only rows with these words (/)";
    words.ariaLabel = words.title;
    words.spellcheck = false;
    on(words, "keydown", (event) => this.#onFilterKey(event), signal);
    on(words, "input", () => setTraits(this.#model, { words: words.value } as Partial<Traits>), signal);
    this.#card.addControls(words, this.#level);
  }

  get #isInPlayer(): boolean {
    return this.#model.get("_span").length > 0;
  }

  get #times(): Times {
    return { span: this.#model.get("_span"), start: this.#model.get("_start") };
  }

  /** The time on show: the frozen moment, else the cursor; null while live without a cursor. */
  get #cursor(): number | null {
    const { paused, shown } = this.#stream;
    if (paused && this.#isInPlayer && shown) return shown.seconds;
    return this.#isInPlayer ? this.#model.get("time") : null;
  }

  #draw(): void {
    const [model, stream, card] = [this.#model, this.#stream, this.#card];
    const all = this.#all();
    const filter = { level: model.get("level"), words: model.get("words") };
    this.#shown = this.#rows.shown(all, filter);
    const cursor = this.#cursor;
    const current = this.#current(cursor);
    const surface = { ...card.size, height: AXIS };
    const span = this.#span(all);
    this.#axis.draw(
      this.#shown,
      { span, times: this.#times, cursor: cursor ?? this.#picking?.seconds ?? null, pointed: this.#hovered },
      surface,
      card.theme,
    );
    card.update([], "event", false);
    const why = all.length
      ? "nothing of this level with these words"
      : this.#isInPlayer
        ? "no events"
        : card.waiting("event");
    setText(this.#empty, this.#shown.length ? "" : why);
    setHidden(this.#empty, this.#shown.length > 0);
    this.#axis.root.style.marginTop = `${card.noticeHeight}px`;
    const isLive = !this.#isInPlayer && !stream.paused;
    this.#list.update({ rows: this.#shown, times: this.#times, current, open: this.#open }, isLive);
    if (this.#level.value !== filter.level) this.#level.value = filter.level;
    if (this.#words.value !== filter.words) this.#words.value = filter.words;
    this.#drawFooter(all);
    this.#hear(all, isLive);
  }

  /** Number of rows that Python has forgotten. */
  get #older(): number {
    return (this.#stream.about as EventsAbout).older ?? 0;
  }

  /** The rows up to the moment on show; while live rows are frozen, the rows of that moment. */
  #all(): Row[] {
    const rows = this.#rows.all(this.#model.get("_old"), this.#model.get("_new"), this.#older);
    const { paused, shown } = this.#stream;
    if (!paused || this.#isInPlayer || !shown) {
      this.#frozen = null;
      return rows;
    }
    const last = this.#frozen?.at(-1)?.number;
    if (!this.#frozen || last !== shown.stop - 1) this.#frozen = rows.filter(({ number }) => number < shown.stop);
    return this.#frozen;
  }

  get #picking(): Row | undefined {
    return this.#shown.find(({ number }) => number === this.#picked);
  }

  /** Index of the current row: the row at the cursor's time, or, live, the row that the user picked. */
  #current(cursor: number | null): number {
    if (cursor !== null) return rowAt(this.#shown, cursor);
    return this.#shown.findIndex(({ number }) => number === this.#picked);
  }

  #span(all: Row[]): Span {
    const [start, end] = this.#model.get("_span");
    if (start !== undefined && end !== undefined) return [start, Math.max(end, start + 1e-3)];
    const [first, last] = [all[0]?.seconds ?? 0, all.at(-1)?.until ?? 0];
    return [first, Math.max(last, first + 1)];
  }

  #drawFooter(all: Row[]): void {
    const { errors, warnings, others } = countLevels(all);
    const some = (count: number, sign: string, noun: string) =>
      count ? `${sign} ${toCount(count)} ${noun}${count === 1 ? "" : "s"}` : "";
    setText(this.#errors, some(errors, "\u2715", "error"));
    setText(this.#warnings, some(warnings, "\u25B2", "warning"));
    setText(
      this.#others,
      others ? `${toCount(others)} ${errors || warnings ? "more" : others === 1 ? "event" : "events"}` : "",
    );
    setText(this.#extent, toExtent(this.#shown.length, all.length, this.#older));
  }

  /** Announces new rows to a screen reader, one a second at most, the worst first. */
  #hear(all: Row[], isLive: boolean): void {
    const next = (all.at(-1)?.number ?? -1) + 1;
    if (!isLive || this.#said === Infinity) this.#said = next;
    else if (next > this.#said) this.#sayNew();
  }

  #say(): void {
    const fresh = this.#shown.filter(({ number }) => number >= this.#said);
    const worst = fresh.reduce<Row | undefined>((a, b) => (!a || b.level > a.level ? b : a), undefined);
    this.#said = (this.#shown.at(-1)?.number ?? -1) + 1;
    if (worst) this.#card.say(toSpoken(worst, this.#times));
  }

  #timeAt(event: MouseEvent): number {
    return toTime(this.#axis.axis, pointIn(this.#axis.root, event).x);
  }

  /** Shows the moment under the pointer in all widgets of a player. */
  #point(seconds: number | null): void {
    if (seconds === this.#hovered) return;
    this.#hovered = seconds;
    if (this.#isInPlayer) this.#model.set("_pointed", seconds === null ? null : { time: seconds, ray: null });
    this.#card.redraw();
  }

  #onPick(row: Row): void {
    this.#open = this.#open === row.number ? null : row.number;
    this.#pick(row);
  }

  /** Goes to the moment of a row in a player. */
  #pick(row: Row): void {
    this.#picked = row.number;
    if (this.#isInPlayer) setTraits(this.#model, { time: row.seconds } as Partial<Traits>);
    this.#card.redraw();
  }

  /** Goes to a time on the axis, or, live, to the row at that time. */
  #goTo(seconds: number): void {
    if (this.#isInPlayer) {
      setTraits(this.#model, { time: seconds } as Partial<Traits>);
      return;
    }
    const row = this.#shown[Math.max(0, rowAt(this.#shown, seconds))];
    if (row) this.#pick(row);
  }

  #onKey(event: KeyboardEvent): void {
    if (!isPlain(event) || event.target instanceof HTMLSelectElement) return;
    const by = WALK[event.key];
    if (event.key === "/") this.#words.focus();
    else if (event.target !== this.#card.picture) return;
    else if (by !== undefined && this.#shown.length) this.#walk(by);
    else if (event.key === "Enter" && this.#walked >= 0) this.#toggle();
    else if (event.key === "Escape" && (this.#open !== null || this.#picked !== null)) this.#release();
    else return;
    event.preventDefault();
    this.#card.redraw();
  }

  /** Empties the filter, or leaves it if it is empty, on Escape; all other keys are for its text. */
  #onFilterKey(event: KeyboardEvent): void {
    event.stopPropagation();
    if (event.key !== "Escape" && event.key !== "Enter") return;
    event.preventDefault();
    if (event.key === "Escape" && this.#words.value) setTraits(this.#model, { words: "" } as Partial<Traits>);
    else this.#card.picture.focus({ preventScroll: true });
  }

  #toggle(): void {
    const row = this.#shown[this.#walked];
    this.#open = row && this.#open !== row.number ? row.number : null;
  }

  #release(): void {
    if (this.#open !== null) this.#open = null;
    else this.#picked = null;
  }

  /** Index of the row from which arrow keys move. */
  get #walked(): number {
    return this.#current(this.#cursor);
  }

  #walk(by: number): void {
    const last = this.#shown.length - 1;
    const from = this.#walked;
    const to = from < 0 && by < 0 ? last : from + by;
    const row = this.#shown[Math.min(last, Math.max(0, to))];
    if (!row) return;
    if (this.#open !== null) this.#open = row.number;
    this.#pick(row);
    this.#list.reveal(this.#shown.indexOf(row));
    this.#card.say(toSpoken(row, this.#times));
  }
}
