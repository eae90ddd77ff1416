import { make, makeButton, makeSvg, mount, set, setHidden, setLabel, setText } from "../shared/dom.ts";
import { isPlain, on, onAbort } from "../shared/events.ts";
import { toAge, toFixed } from "../shared/format.ts";
import { keepKeys } from "../shared/keys.ts";
import { lacksKernel, type Model, NO_KERNEL, newName, onChange, onMessage, setTraits } from "../shared/model.ts";
import { setHeld } from "../shared/room.ts";
import { perAnimationFrame, throttle } from "../shared/schedule.ts";
import { watchSeen } from "../shared/seen.ts";
import { followTheme } from "../shared/theme.ts";
import { Cards } from "./cards.ts";
import {
  canBeLaser,
  type Group,
  nameIn,
  shortType,
  toCount,
  toFacts,
  toFewWords,
  toFolded,
  toGroups,
  toRate,
} from "./groups.ts";
import { makeTypeIcon } from "./icons.ts";
import type { TopicRow, TopicsTraits } from "./traits.ts";

const ROW = 20;
/** Most rows on the page; more would be slow to lay out, and too many to read. */
const MOST_ROWS = 400;
/** Milliseconds after which a kernel that has not answered is busy. */
const BUSY_MS = 700;
/** Milliseconds of a finger on a row, after which the row gets the focus without a click. */
const LONG_MS = 500;
/** Milliseconds between two requests for the values of other rows. */
const LOOK_MS = 250;
/** Greatest number of requested values. */
const MOST_VALUES = 100;

/** The name of the wires in a request, instead of a topic. */
const WIRES = "the wires";

const NO_ROW: TopicRow = { name: "", type: "", messages: null, rate: null, widget: "", problem: "" };

/**
 * A message of Python: a finished request, or the values of topics at a time, or the values of a robot's topics now.
 */
interface Message {
  done?: string;
  values?: Record<string, string>;
  at?: number | null;
  now?: Record<string, Now>;
}

/** The present count and rate of a robot's topic; null if unknown. */
interface Now {
  rate: number | null;
  messages: number | null;
  /** The seconds of its silence, if it is silent. */
  silent?: number;
}

/** A row or a heading on the page. */
interface Line {
  element: HTMLElement;
  group: Group;
  /** Null for a heading. */
  row: TopicRow | null;
}

/** The list of all topics: a click shows one or takes it off. It folds away to a rail. */
export class TopicsView {
  readonly #model: Model<TopicsTraits>;
  readonly #name = newName();
  readonly #root = make("div", "rw-card rw-topics");
  readonly #rail: HTMLButtonElement;
  readonly #railText = make("span", "");
  readonly #facts = make("span", "rw-facts");
  readonly #when = make("span", "");
  readonly #wires: HTMLButtonElement;
  readonly #search: HTMLButtonElement;
  readonly #filter = make("input", "rw-field rw-topics-filter");
  readonly #unit: HTMLButtonElement;
  readonly #body = make("div", "rw-topics-body");
  readonly #live = make("div", "rw-unseen");
  readonly #footName = make("b", "");
  readonly #footType = make("span", "rw-topics-foot-type");
  readonly #footFacts = make("div", "rw-topics-foot-facts");
  readonly #footButton: HTMLButtonElement;
  readonly #asLaser: HTMLButtonElement;
  readonly #cards: Cards;
  readonly #signal: AbortSignal;
  readonly #redraw: () => void;
  #lines: Line[] = [];
  #at = "";
  #showsCounts = false;
  readonly #byHand = new Map<string, boolean>();
  /** Requests that are not answered yet: by name, true to show it. */
  readonly #pending = new Map<string, boolean>();
  #isBusy = false;
  /** True while a pointer presses a row. A row that is replaced in the meantime gets no click. */
  #isPressed = false;
  #values: Record<string, string> = {};
  #asked: string[] = [];
  #now: Record<string, Now> = {};
  #isSeen = false;
  /** The time of these values. */
  #valuesAt: number | null = null;
  readonly #look: () => void;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #room = 0;

  constructor(model: Model<TopicsTraits>, element: HTMLElement, signal: AbortSignal) {
    this.#model = model;
    this.#signal = signal;
    this.#cards = new Cards(this.#root);
    this.#redraw = perAnimationFrame(() => this.#draw(), signal);
    this.#rail = makeButton("rw-topics-rail", "", () => this.#fold(false), signal);
    this.#rail.append(makeLine("M1.5 3h1M5 3h6M1.5 6h1M5 6h6M1.5 9h1M5 9h6"), this.#railText);
    this.#search = makeButton("rw-topics-search", "Filter by name and type (/)", () => this.#openFilter(), signal);
    this.#search.append(makeLine("M5 1.5a3.5 3.5 0 1 0 0 7a3.5 3.5 0 1 0 0-7M7.7 7.7L11 11"));
    this.#wires = makeButton("rw-topics-wires", "", () => this.#send(WIRES, !this.#hasWires), signal, "Wires");
    const fold = makeButton("rw-topics-fold", "Fold the list away", () => this.#fold(true), signal);
    fold.append(makeLine("M6 2L2 6l4 4M10 2L6 6l4 4"));
    this.#unit = makeButton("rw-topics-unit", "", () => this.#toggleUnit(), signal);
    this.#footButton = makeButton("rw-topics-show", "", () => this.#toggleAt(), signal);
    this.#footButton.ariaLabel = null;
    const asLaser = "Show it in a laser widget: a band of heights of a cloud, or of rows of a depth image";
    this.#asLaser = makeButton("rw-topics-show", asLaser, () => this.#showAsLaser(), signal, "As laser");
    onAbort(signal, () => clearTimeout(this.#timer));
    this.#root.append(this.#rail, this.#makePanel(fold), this.#live);
    this.#root.role = "group";
    this.#root.ariaLabel = "topics";
    this.#live.ariaLive = "polite";
    mount(element, this.#root, signal);
    followTheme(this.#root, model, signal);
    keepKeys(this.#root, signal);
    onChange(model, ["_rows", "_shown", "folded", "wires", "_fixed", "_error"], this.#redraw, signal);
    onMessage(model, (message: Message) => this.#onMessage(message), signal);
    this.#look = throttle(() => this.#askForValues(), LOOK_MS, signal);
    const onBeat = (isSeen: boolean) => {
      this.#isSeen = isSeen;
      this.#askForValues(true);
    };
    watchSeen(this.#body, onBeat, signal);
    // One observer for all rows: there may be many.
    const size = new ResizeObserver(() => this.#onSize());
    size.observe(this.#body);
    onAbort(signal, () => size.disconnect());
    this.#draw();
  }

  #makePanel(fold: HTMLElement): HTMLElement {
    const panel = make("div", "rw-topics-panel");
    const header = make("div", "rw-header");
    const controls = make("span", "rw-controls");
    controls.append(this.#wires, this.#search, fold);
    header.append(make("span", "rw-title", "Topics"), this.#facts, controls);
    this.#filter.type = "search";
    this.#filter.placeholder = "name or type";
    this.#filter.ariaLabel = "Filter topics by name and type";
    this.#filter.hidden = true;
    on(this.#filter, "input", this.#redraw, this.#signal);
    on(this.#filter, "keydown", (event) => this.#onFilterKey(event), this.#signal);
    const head = make("div", "rw-topics-head");
    head.append(make("span", "rw-topics-head-names", "show · name · type"), this.#when, this.#unit);
    this.#body.role = "treegrid";
    this.#body.ariaLabel = "topics";
    on(this.#body, "keydown", (event) => this.#onKey(event), this.#signal);
    on(this.#body, "click", (event) => this.#onClick(event), this.#signal);
    on(this.#body, "pointerover", (event) => this.#onPoint(event), this.#signal);
    on(this.#body, "pointerleave", () => this.#cards.light([]), this.#signal);
    on(this.#body, "focusin", (event) => this.#onFocus(event), this.#signal);
    this.#watchPresses();
    const foot = make("div", "rw-topics-foot");
    const first = make("div", "rw-topics-foot-row");
    first.append(this.#footName, this.#footType, this.#asLaser, this.#footButton);
    foot.append(first, this.#footFacts);
    panel.append(header, this.#filter, head, this.#body, foot);
    return panel;
  }

  get #canChange(): boolean {
    return !this.#model.get("_fixed") && !lacksKernel(this.#model);
  }

  #isShown(name: string): boolean {
    return this.#pending.get(name) ?? name in this.#model.get("_shown");
  }

  get #hasWires(): boolean {
    return this.#pending.get(WIRES) ?? this.#model.get("wires");
  }

  get #rows(): TopicRow[] {
    return this.#model.get("_rows");
  }

  get #row(): TopicRow | undefined {
    return this.#rows.find(({ name }) => name === this.#at);
  }

  // -- drawing -------------------------------------------------------------------------------------------------------

  #draw(): void {
    const rows = this.#rows;
    const shown = rows.filter(({ name }) => this.#isShown(name)).length;
    const isMissing = rows.some(
      ({ name, messages: count, problem }) => !problem && count !== 0 && !this.#isShown(name),
    );
    const folded = this.#model.get("folded");
    const open = folded === null ? (isMissing ? "auto" : "no") : folded ? "no" : "yes";
    if (this.#root.dataset.open !== open) {
      this.#root.dataset.open = open;
      for (const one of ["auto", "no", "yes"]) setHeld(this.#root, `topics-${one}`, one === open);
    }
    this.#root.toggleAttribute("data-fixed", !this.#canChange);
    setText(this.#railText, `Topics ${shown} / ${rows.length}`);
    setLabel(this.#rail, `List all topics: ${shown} of ${rows.length} are shown`);
    setText(this.#facts, `${shown} of ${rows.length}`);
    set(this.#facts, "title", `${shown} of ${rows.length} are shown`);
    setHidden(this.#wires, !this.#canChange);
    set(this.#wires, "ariaPressed", String(this.#hasWires));
    setLabel(this.#wires, this.#hasWires ? "Show the wires no more" : "Show who publishes and takes each topic, below");
    setText(this.#unit, this.#showsCounts ? "count ▾" : "Hz ▾");
    setLabel(this.#unit, this.#showsCounts ? "Messages; to Hz" : "Messages per second; to their number");
    this.#drawRows(rows);
    this.#drawFoot();
  }

  #drawRows(rows: TopicRow[]): void {
    if (this.#isPressed) return; // they are drawn once it is lifted
    const filter = this.#filter.hidden ? "" : this.#filter.value;
    const groups = toGroups(rows, filter);
    const room = this.#room || rows.length;
    const folded = filter ? new Set<string>() : toFolded(groups, (name) => this.#isShown(name), room, this.#byHand);
    const hadFocus = this.#body.contains(document.activeElement);
    const { scrollTop } = this.#body;
    const lines: Line[] = [];
    for (const group of groups) {
      if (group.name) lines.push({ element: this.#makeHeading(group, folded.has(group.name)), group, row: null });
      if (folded.has(group.name)) continue;
      for (const row of group.rows) lines.push({ element: this.#makeRow(group, row), group, row });
    }
    this.#lines = lines.slice(0, MOST_ROWS);
    const elements = this.#lines.map((line) => line.element);
    const left = lines.length - this.#lines.length;
    const more = left
      ? [make("div", "rw-topics-more", `and ${left.toLocaleString("en")} more: filter them by name`)]
      : [];
    const none = lines.length
      ? []
      : [make("div", "rw-topics-more", rows.length ? "none of this name" : "no topic yet")];
    this.#body.replaceChildren(...elements, ...more, ...none);
    this.#body.scrollTop = scrollTop;
    this.#look();
    const at = this.#lineAt() ?? this.#lines[0];
    if (at) {
      at.element.tabIndex = 0;
      if (hadFocus) at.element.focus({ preventScroll: true });
    }
  }

  #makeHeading(group: Group, isFolded: boolean): HTMLElement {
    const heading = make("div", "rw-topics-group");
    heading.role = "row";
    heading.tabIndex = -1;
    heading.dataset.key = `group ${group.name}`;
    heading.ariaExpanded = String(!isFolded);
    heading.ariaLevel = "1";
    heading.append(make("span", "rw-topics-sign", isFolded ? "▸" : "▾"), make("b", "", group.name));
    heading.append(make("span", "rw-topics-number", `${group.rows.length}`));
    if (isFolded) {
      const inside = group.rows.slice(0, 8).map(({ name }) => nameIn(group, name));
      heading.append(make("span", "rw-topics-inside", inside.join(", ")));
    }
    return heading;
  }

  #makeRow(group: Group, row: TopicRow): HTMLElement {
    const { name, type, problem } = row;
    const { messages: count, rate } = this.#countsOf(row);
    const line = make("div", "rw-topic");
    line.role = "row";
    line.tabIndex = -1;
    line.dataset.key = name;
    line.ariaLevel = group.name ? "2" : "1";
    const isShown = this.#isShown(name);
    line.toggleAttribute("data-shown", isShown);
    line.toggleAttribute("data-pending", this.#pending.has(name));
    line.toggleAttribute("data-in-group", Boolean(group.name));
    line.toggleAttribute("data-unreadable", Boolean(problem));
    line.toggleAttribute("data-at", name === this.#at);
    const short = shortType(type) || "unknown type";
    const words = [name, short, ...toFacts(count, rate), problem || (isShown ? "shown" : "not shown")];
    line.ariaLabel = words.join(", ");
    line.title = name;
    line.append(make("span", "rw-topic-square"), makeTypeIcon(short), makeName(nameIn(group, name)));
    if (problem) line.append(make("span", "rw-topic-why", problem));
    else line.append(make("span", "rw-topic-type", short), make("span", "rw-topic-value"));
    if (!problem) line.append(make("span", "rw-topic-rate"));
    this.#writeValue(line, row);
    for (const cell of line.children) cell.role = "gridcell";
    return line;
  }

  #drawFoot(): void {
    const row = this.#row;
    const error = this.#model.get("_error");
    const { name, type, widget, problem } = row ?? NO_ROW;
    const { messages: count, rate } = this.#countsOf(row ?? NO_ROW);
    setText(this.#footName, name);
    setText(this.#footType, type);
    set(this.#footName, "title", name);
    set(this.#footType, "title", type);
    const isShown = this.#isShown(name);
    const by = widget && !problem ? [`shown by ${widget}`] : [];
    const waits = this.#pending.size > 0 && this.#isBusy;
    const text = waits
      ? "the kernel is busy: it follows when the cell ends"
      : error ||
        problem ||
        [this.#values[name] ?? "", ...this.#silence(name), ...toFacts(count, rate), ...by].filter(Boolean).join(" · ");
    const help =
      lacksKernel(this.#model) && !this.#model.get("_fixed") ? NO_KERNEL : "point at a topic, or type / to filter";
    setText(this.#footFacts, text || (row ? "" : help));
    set(this.#footFacts, "title", text);
    setHidden(this.#footButton, !row || !this.#canChange || (Boolean(problem) && !isShown));
    setHidden(this.#asLaser, !row || !this.#canChange || !canBeLaser(row));
    setText(this.#footButton, isShown ? "Take off" : "Show");
    set(this.#footButton, "title", isShown ? "Take it off the screen (space)" : "Put it on the screen (space)");
  }

  #onSize(): void {
    const row = this.#lines.find((line) => line.row)?.element.offsetHeight || ROW;
    const there = Math.floor(this.#body.clientHeight / row);
    if (there === this.#room) return;
    this.#room = there;
    this.#redraw();
  }

  // -- actions of the user
  // -----------------------------------------------------------------------------------------------

  #fold(folded: boolean): void {
    setTraits(this.#model, { folded });
    this.#draw();
    const next = folded ? this.#rail : (this.#lineAt() ?? this.#lines[0])?.element;
    next?.focus({ preventScroll: true });
  }

  #toggleUnit(): void {
    this.#showsCounts = !this.#showsCounts;
    this.#draw();
  }

  #toggleAt(): void {
    if (this.#row) this.#toggle(this.#row);
  }

  /** Shows a topic or removes it: Python does it, and may be busy. */
  #toggle({ name, problem }: TopicRow): void {
    const isShown = this.#isShown(name);
    if (this.#canChange && (!problem || isShown)) this.#send(name, !isShown);
  }

  #showAsLaser(): void {
    if (this.#row) this.#send(`${this.#row.name} as scan`, true);
  }

  /** Asks Python to show a topic, or the wires, or to remove them. */
  #send(name: string, isOn: boolean): void {
    this.#pending.set(name, isOn);
    this.#model.send({ toggle: name, on: isOn });
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => {
      this.#isBusy = this.#pending.size > 0;
      this.#redraw();
    }, BUSY_MS);
    this.#redraw();
  }

  #onMessage({ done, values, at, now }: Message): void {
    if (done !== undefined) this.#onDone(done);
    if (!values) return;
    const isMore = !now && (at ?? null) === this.#valuesAt;
    this.#values = { ...(isMore && this.#values), ...values };
    this.#valuesAt = at ?? null;
    this.#now = now ?? {};
    // Python reads for a moment at a time.
    const missing = now ? [] : this.#asked.filter((name) => !(name in this.#values));
    if (missing.length && Object.keys(values).length) this.#model.send({ more: missing });
    setText(this.#when, at === null || at === undefined ? "now" : `at ${toFixed(at, 2)} s`);
    for (const { element, row } of this.#lines) if (row) this.#writeValue(element, row);
    this.#drawFoot();
  }

  #writeValue(line: HTMLElement, row: TopicRow): void {
    const cell = line.querySelector<HTMLElement>(".rw-topic-value");
    if (cell) setText(cell, toFewWords(this.#values[row.name] ?? ""));
    const { messages: count, rate } = this.#countsOf(row);
    const number = this.#showsCounts ? toCount(count) : toRate(count, rate);
    const rated = line.querySelector<HTMLElement>(".rw-topic-rate");
    if (rated) setText(rated, count === 0 ? "none" : number);
  }

  /** Count and rate of the recording, or of the present. */
  #countsOf(row: TopicRow): { messages: number | null; rate: number | null } {
    return this.#now[row.name] ?? row;
  }

  #silence(name: string): string[] {
    const seconds = this.#now[name]?.silent;
    return seconds === undefined ? [] : [`silent for ${toAge(1000 * seconds, 0)}`];
  }

  /**
   * Requests the values of the rows on the page; folded rows have none. @param again true to request known values, too
   */
  #askForValues(again = false): void {
    if (!this.#canChange) return;
    const rows = this.#lines.flatMap(({ row }) => (row && !row.problem && row.messages !== 0 ? [row] : []));
    const names = this.#isSeen ? rows.slice(0, MOST_VALUES).map(({ name }) => name) : [];
    if (!again && names.join("\n") === this.#asked.join("\n")) return;
    this.#asked = names;
    this.#model.send({ look: names, view: this.#name });
  }

  #onDone(name: string): void {
    const wanted = this.#pending.get(name);
    this.#pending.delete(name);
    this.#isBusy = false;
    const isShown = name === WIRES ? this.#model.get("wires") : name in this.#model.get("_shown");
    if (wanted === isShown) this.#live.textContent = `${name} ${isShown ? "shown" : "taken off"}`;
    this.#redraw();
  }

  #onClick(event: MouseEvent): void {
    const line = this.#lineOf(event.target);
    if (!line) return;
    this.#goTo(line, false);
    if (!line.row) this.#setFolded(line.group.name, line.element.ariaExpanded === "true");
    else if (isIn(event.target, ".rw-topic-value") && this.#isShown(line.row.name)) this.#scrollTo(line.row.name);
    else this.#toggle(line.row);
  }

  /** Keeps the rows while one is pressed, and moves the focus to one under a resting finger, whose click has no effect. */
  #watchPresses(): void {
    let timer: ReturnType<typeof setTimeout> | undefined;
    let isLong = false;
    const end = () => clearTimeout(timer);
    onAbort(this.#signal, end);
    const onDown = (event: PointerEvent) => {
      isLong = false;
      const line = this.#lineOf(event.target);
      this.#isPressed = line !== undefined;
      if (event.pointerType !== "touch" || !line) return;
      timer = setTimeout(() => {
        isLong = true;
        this.#goTo(line, false);
      }, LONG_MS);
    };
    on(this.#body, "pointerdown", onDown, this.#signal);
    const onLifted = () => {
      end();
      if (this.#isPressed) this.#redraw(); // in the next frame, after the click
      this.#isPressed = false;
    };
    // It may be lifted elsewhere.
    for (const type of ["pointerup", "pointercancel"] as const)
      on(window, type, onLifted, this.#signal, { capture: true });
    const onClick = (event: MouseEvent) => isLong && event.stopImmediatePropagation();
    on(this.#body, "click", onClick, this.#signal, { capture: true });
  }

  #onPoint(event: PointerEvent): void {
    const line = this.#lineOf(event.target);
    if (event.pointerType === "touch" || !line) return;
    this.#cards.light(line.row ? (this.#model.get("_shown")[line.row.name] ?? []) : []);
    if (line.row && !this.#body.contains(document.activeElement)) this.#lookAt(line);
  }

  #onFocus(event: FocusEvent): void {
    const line = this.#lineOf(event.target);
    if (line) this.#lookAt(line);
  }

  #lookAt(line: Line): void {
    const key = line.element.dataset.key ?? "";
    if (key === this.#at) return;
    for (const one of this.#lines) one.element.toggleAttribute("data-at", one === line);
    for (const one of this.#lines) one.element.tabIndex = one === line ? 0 : -1;
    this.#at = key;
    this.#drawFoot();
  }

  #goTo(line: Line, scrolls: boolean): void {
    this.#lookAt(line);
    line.element.focus({ preventScroll: true });
    if (scrolls) line.element.scrollIntoView({ block: "nearest" });
  }

  #scrollTo(name: string): void {
    this.#cards.show(this.#model.get("_shown")[name] ?? []);
  }

  #setFolded(name: string, isFolded: boolean): void {
    this.#byHand.set(name, isFolded);
    this.#draw();
  }

  #onKey(event: KeyboardEvent): void {
    if (!isPlain(event)) return;
    const place = this.#lines.findIndex((line) => line.element.dataset.key === this.#at);
    const line = this.#lines[place];
    const take = () => {
      event.preventDefault();
      event.stopPropagation();
    };
    if (event.key === "/") {
      take();
      this.#openFilter();
    } else if (event.key === "Escape") {
      take();
      this.#closeFilter();
    } else if (event.key === "ArrowDown" || event.key === "ArrowUp") {
      take();
      const next = this.#lines[place + (event.key === "ArrowDown" ? 1 : -1)];
      if (next) this.#goTo(next, true);
    } else if (event.key === "Home" || event.key === "End") {
      take();
      const next = event.key === "Home" ? this.#lines[0] : this.#lines.at(-1);
      if (next) this.#goTo(next, true);
    } else if (line && (event.key === "ArrowLeft" || event.key === "ArrowRight")) {
      take();
      const heading = this.#lines.find((one) => !one.row && one.group.name === line.group.name);
      if (event.key === "ArrowLeft" && line.row && heading) this.#goTo(heading, true);
      else if (!line.row) this.#setFolded(line.group.name, event.key === "ArrowLeft");
    } else if (line && event.key === " ") {
      take();
      if (line.row) this.#toggle(line.row);
      else this.#setFolded(line.group.name, line.element.ariaExpanded === "true");
    } else if (line?.row && event.key === "Enter") {
      take();
      this.#scrollTo(line.row.name);
    }
  }

  #openFilter(): void {
    this.#filter.hidden = false;
    this.#filter.focus();
    this.#search.ariaPressed = "true";
  }

  #closeFilter(): void {
    if (this.#filter.hidden) {
      (document.activeElement as HTMLElement | null)?.blur();
      return;
    }
    this.#filter.value = "";
    this.#filter.hidden = true;
    this.#search.ariaPressed = "false";
    this.#draw();
    (this.#lineAt() ?? this.#lines[0])?.element.focus({ preventScroll: true });
  }

  #onFilterKey(event: KeyboardEvent): void {
    event.stopPropagation();
    if (event.key === "Escape" && this.#filter.value) {
      event.preventDefault();
      this.#filter.value = "";
      this.#redraw();
    } else if (event.key === "Escape") {
      this.#closeFilter();
    } else if (event.key === "ArrowDown" || event.key === "Enter") {
      event.preventDefault();
      const first = this.#lines.find((line) => line.row);
      if (first) this.#goTo(first, true);
    }
  }

  #lineAt(): Line | undefined {
    return this.#lines.find((line) => line.element.dataset.key === this.#at);
  }

  #lineOf(target: EventTarget | null): Line | undefined {
    return this.#lines.find((line) => target instanceof Node && line.element.contains(target));
  }
}

function isIn(target: EventTarget | null, selector: string): boolean {
  return target instanceof Element && target.closest(selector) !== null;
}

/** A name that loses its middle first. */
function makeName(name: string): HTMLElement {
  const TAIL = 9;
  const whole = make("span", "rw-topic-name");
  if (name.length <= 2 * TAIL) whole.append(make("span", "rw-topic-name-head", name));
  else whole.append(make("span", "rw-topic-name-head", name.slice(0, -TAIL)), make("span", "", name.slice(-TAIL)));
  return whole;
}

/** An icon of lines, 12 by 12. */
function makeLine(d: string): SVGElement {
  const icon = makeSvg("svg", { viewBox: "0 0 12 12", class: "rw-topics-line", "aria-hidden": "true" });
  icon.append(makeSvg("path", { d }));
  return icon;
}
