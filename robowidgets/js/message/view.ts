import { copyText } from "../shared/copy.ts";
import { make, makeButton, set, setHidden, setText } from "../shared/dom.ts";
import { isPlain, on, onAbort } from "../shared/events.ts";
import { toCount, toFixed } from "../shared/format.ts";
import { lacksKernel, type Model, onChange, setTraits } from "../shared/model.ts";
import { quoted } from "../shared/python.ts";
import { SampleCard } from "../shared/sample_card.ts";
import type { Stream } from "../shared/stream.ts";
import type { Moment, Recent } from "../shared/traits.ts";
import { decodeMessage, type Packed } from "./frame.ts";
import { Readout } from "./readout.ts";
import { Seen, type Table, toTable } from "./table.ts";
import { TableView } from "./table_view.ts";
import { toCode, toNote, toSpoken, toWhole } from "./text.ts";
import type { MessageAbout, MessageTraits } from "./traits.ts";
import { type Field, find, isSame, toFields, toNumber } from "./tree.ts";
import { TreeLineView } from "./tree_line_view.ts";
import { type TreeLine, toTreeLines } from "./tree_lines.ts";

/** Least milliseconds for which a change is marked. */
const LIT_MS = 300;
/** Messages of a player in the last seconds, at most. */
const MOST_RECENT = 1000;
const COPIED_MS = 2000;
/** Pixels from which on there is room for the package of a type. */
const WIDE = 520;
/** Pixels below which the buttons of a line have short names, as in its stylesheet. */
const NARROW = 400;
const WALK: Record<string, number> = { ArrowDown: 1, ArrowUp: -1, Home: -Infinity, End: Infinity };

/** One view of a message widget: it wires the card, the tree or the table, the buttons of a line, and the keys. */
export class MessageView {
  readonly #model: Model<MessageTraits>;
  readonly #stream: Stream<Packed>;
  readonly #card: SampleCard;
  readonly #scroll = make("div", "rw-message-scroll rw-pale");
  readonly #tree = make("div", "rw-message-tree");
  readonly #empty = make("div", "rw-empty");
  readonly #table = new TableView();
  readonly #readout = new Readout();
  readonly #form: HTMLButtonElement;
  readonly #changes: HTMLButtonElement;
  readonly #actions = make("span", "rw-message-actions");
  readonly #watch: HTMLButtonElement;
  readonly #copy: HTMLButtonElement;
  readonly #plot: HTMLButtonElement;
  readonly #told = make("span", "rw-message-told");
  readonly #place = make("span", "rw-message-place");
  readonly #code = make("textarea", "rw-code rw-message-code");
  readonly #views: TreeLineView[] = [];
  readonly #seen = new Seen();
  /** End of the marks of the lines of these paths. */
  readonly #lit = new Map<string, number>();
  readonly #numbers = new WeakMap<DataView, Map<string, number | null>>();
  #lines: TreeLine[] = [];
  #fields: Field[] = [];
  /** The fields that were on show before, and the number of their message. */
  #before: { sequence: number; fields: Field[] } = { sequence: NaN, fields: [] };
  #tabled: Table | null = null;
  #active = "";
  #hovered = "";
  #copied = "";
  #timer: ReturnType<typeof setTimeout> | undefined;
  #dimmer: ReturnType<typeof setTimeout> | undefined;

  constructor(model: Model<MessageTraits>, element: HTMLElement, stream: Stream<Packed>, signal: AbortSignal) {
    this.#model = model;
    this.#stream = stream;
    const card = new SampleCard(element, "message", model, stream, () => this.#draw(), signal);
    this.#card = card;
    this.#tree.role = "tree";
    this.#tree.ariaLabel = "fields";
    this.#scroll.append(this.#tree, this.#table.root, this.#readout.root);
    card.picture.append(this.#scroll, this.#empty);
    this.#watch = makeButton("rw-message-watch", "", () => this.#toggleWatch(), signal, "Watch");
    this.#copy = makeButton("rw-message-copy", "", () => void this.#copyPath(), signal, "Copy path");
    this.#plot = makeButton("rw-message-plot", "", () => this.#askForPlot(), signal, "Plot");
    this.#plot.title = "Show a plot of it (Enter)";
    for (const button of [this.#plot, this.#watch, this.#copy]) {
      button.ariaLabel = null;
      button.tabIndex = -1;
    }
    this.#actions.append(this.#plot, this.#watch, this.#copy);
    this.#form = makeButton("rw-message-form", "", () => this.#toggle("rows"), signal);
    this.#form.ariaLabel = null;
    this.#changes = makeButton("rw-message-changes", "", () => this.#toggle("changes"), signal, "Changed");
    this.#changes.ariaLabel = null;
    this.#changes.title = "Mark what changed since the message before";
    card.addControls(this.#form, this.#changes);
    this.#code.readOnly = true;
    this.#code.ariaLabel = "code to copy";
    setHidden(this.#code, true);
    card.footer.append(this.#told, this.#place);
    card.picture.append(this.#code);
    onChange(model, ["fields", "over_time", "rows", "folds", "changes"], () => card.drawNow(), signal);
    onAbort(signal, () => {
      clearTimeout(this.#timer);
      clearTimeout(this.#dimmer);
    });
    const keyAt = ({ target }: Event) =>
      target instanceof Element ? (target.closest<HTMLElement>("[data-rw-row]")?.dataset.rwRow ?? "") : "";
    const onHover = (event: PointerEvent) => event.pointerType !== "touch" && this.#hover(keyAt(event));
    on(this.#scroll, "pointerover", onHover, signal);
    on(this.#scroll, "pointerleave", () => this.#hover(""), signal);
    on(this.#scroll, "click", (event) => this.#onClick(keyAt(event), event), signal);
    on(this.#tree, "focusin", (event) => this.#activate(keyAt(event)), signal);
    on(card.root, "keydown", (event) => this.#onKey(event), signal);
    on(this.#code, "keydown", (event) => event.key !== "Escape" && event.stopPropagation(), signal);
  }

  get #about(): MessageAbout {
    return this.#stream.about as MessageAbout;
  }

  // -- drawing -------------------------------------------------------------------------------------------------------

  #draw(): void {
    const [card, stream, model] = [this.#card, this.#stream, this.#model];
    const { shown } = stream;
    const watched = model.get("over_time");
    card.alsoNumbers = watched.length ? (moment) => this.#numbersOf(moment, watched) : null;
    const needs = watched.length ? MOST_RECENT : 1;
    const page = model as Model<Recent>;
    if (page.get("_needs") !== needs) page.set("_needs", needs);
    const { type = "" } = this.#about;
    // A topic that sent one message is not silent.
    card.update([card.width < WIDE ? type.replace(/^.*\//, "") : type], "message", stream.rate > 0);
    const isEmpty = shown === null || this.#about.tree === undefined;
    setText(this.#empty, shown ? "no message up to this time of the recording" : card.waiting("message"));
    setHidden(this.#empty, !isEmpty);
    setHidden(this.#scroll, isEmpty);
    this.#scroll.style.paddingTop = card.noticeHeight ? `${card.noticeHeight}px` : "";
    card.texts.ask(this.#write);
  }

  readonly #write = (): void => {
    const { shown } = this.#stream;
    const { tree = [] } = this.#about;
    if (!shown) return;
    this.#fields = toFields(tree, shown);
    const isAlone = this.#model.get("fields").length > 0;
    this.#tabled = isAlone ? null : toTable(this.#fields, this.#seen);
    const inRows = this.#tabled !== null && this.#model.get("rows");
    setHidden(this.#form, this.#tabled === null);
    setText(this.#form, inRows ? "Tree" : "Rows");
    set(this.#form, "title", inRows ? "Show all fields" : "Show rows with bars");
    set(this.#changes, "ariaPressed", String(this.#model.get("changes")));
    const isChanged = this.#findChanges(shown);
    setHidden(this.#readout.root, !isAlone);
    setHidden(this.#table.root, !inRows);
    setHidden(this.#tree, isAlone || inRows);
    if (isAlone) this.#readout.update(this.#fields, isChanged);
    else if (this.#tabled && inRows) {
      this.#table.update(
        this.#tabled,
        (key) => this.#isChangedAt(key, isChanged),
        (key) => this.#isOpen(key),
      );
    } else this.#writeTree(isChanged);
    this.#tell();
  };

  #writeTree(isChanged: (field: Field) => boolean): void {
    const views = this.#views;
    this.#lines = toTreeLines(this.#fields, this.#model.get("folds"));
    const lines = this.#lines;
    const hadFocus = this.#tree.contains(document.activeElement);
    while (views.length < lines.length) {
      const view = new TreeLineView();
      views.push(view);
      this.#tree.append(view.root);
    }
    for (const { root } of views.splice(lines.length)) root.remove();
    if (!lines.some(({ key }) => key === this.#active)) this.#active = lines[0]?.key ?? "";
    for (const [i, line] of lines.entries()) {
      const view = views[i];
      if (!view) continue;
      view.update(line, line.field !== null && isChanged(line.field));
      const tabIndex = line.key === this.#active ? 0 : -1;
      if (view.root.tabIndex !== tabIndex) view.root.tabIndex = tabIndex;
    }
    this.#placeActions();
    // Lines may have moved under the focus.
    const active = this.#viewOf(this.#active)?.root;
    if (hadFocus && document.activeElement !== active && !this.#actions.contains(document.activeElement)) {
      active?.focus({ preventScroll: true });
    }
  }

  /** Finds the fields that differ from the previous message, and the end of their marks. */
  #findChanges(shown: Packed): (field: Field) => boolean {
    if (!this.#model.get("changes")) return () => false;
    const isPlayed = this.#about.recorded !== undefined;
    const { sequence } = this.#before;
    const isStill = this.#stream.paused || isPlayed;
    const base = isStill ? this.#fieldsBefore() : this.#before.fields;
    const known = new Map<string, Field>();
    const enter = (fields: readonly Field[]) => {
      for (const field of fields) {
        known.set(field.path, field);
        if (field.children) enter(field.children);
      }
    };
    enter(base);
    const now = performance.now();
    const isNew = sequence !== shown.sequence;
    if (isNew) this.#before = { sequence: shown.sequence, fields: this.#fields };
    const lit = this.#lit;
    clearTimeout(this.#dimmer);
    if (lit.size) this.#dimmer = setTimeout(this.#card.redraw, LIT_MS);
    return (field) => {
      const other = known.get(field.path) ?? find(base, field.path);
      const differs = (isNew || isStill) && base.length > 0 && (other === undefined || !isSame(field, other));
      if (isStill) return differs;
      if (differs) lit.set(field.path, now + LIT_MS);
      const until = lit.get(field.path) ?? 0;
      if (until <= now) lit.delete(field.path);
      return until > now;
    };
  }

  #fieldsBefore(): Field[] {
    const [before, last] = this.#stream.last(2);
    if (!before || !last) return [];
    return toFields((before.about as MessageAbout).tree ?? [], this.#stream.frameOf(before));
  }

  /** Returns true if a part of a table's row has changed: elements of several arrays, or a field. */
  #isChangedAt(key: string, isChanged: (field: Field) => boolean): boolean {
    const index = /^name(\[\d+\])$/.exec(key)?.[1];
    const paths = index ? ["position", "velocity", "effort"].map((name) => name + index) : [key];
    return paths.some((path) => {
      const field = find(this.#fields, path);
      return field !== undefined && isChanged(field);
    });
  }

  /** The numbers of a message that are drawn over time; null for a missing one. */
  #numbersOf(moment: Moment, paths: readonly string[]): Record<string, number | null> {
    const known = this.#numbers.get(moment.bytes) ?? new Map<string, number | null>();
    this.#numbers.set(moment.bytes, known);
    if (paths.some((path) => !known.has(path))) {
      const fields = toFields((moment.about as MessageAbout).tree ?? [], decodeMessage(moment.bytes));
      for (const path of paths) {
        const found = find(fields, path);
        const value = found && (found.node.kind === "flag" ? Number(found.value) : toNumber(found.value));
        known.set(path, value === undefined || !Number.isFinite(value) ? null : value);
      }
    }
    return Object.fromEntries(paths.map((path) => [path, known.get(path) ?? null]));
  }

  /** Updates the foot: the line under the pointer or with the focus, and the message that it belongs to. */
  #tell(): void {
    const { shown } = this.#stream;
    const { frame_id = "", recorded } = this.#about;
    const field = this.#fieldOf(this.#hovered || (this.#tree.contains(document.activeElement) ? this.#active : ""));
    const told = field ? [field.path, toWhole(field), toNote(field)].filter(Boolean).join("  ") : frame_id;
    setText(this.#told, this.#copied ? `copied ${this.#copied}` : told);
    set(this.#told, "title", this.#told.textContent);
    const index = (shown?.sequence ?? 1) - 1;
    const seconds = shown?.arrived ?? -1;
    const at = seconds < 0 ? "" : `at ${toFixed(seconds, 3)} s`;
    setText(this.#place, recorded ? at : `message [${toCount(index)}]`);
  }

  // -- lines -------------------------------------------------------------------------------------------------------

  #lineOf(key: string): TreeLine | undefined {
    return this.#lines.find((line) => line.key === key);
  }

  #viewOf(key: string): TreeLineView | undefined {
    return this.#views[this.#lines.findIndex((line) => line.key === key)];
  }

  #fieldOf(key: string): Field | null {
    return (this.#lineOf(key)?.field ?? null) || (this.#model.get("rows") ? (find(this.#fields, key) ?? null) : null);
  }

  #isOpen(key: string): boolean {
    return this.#lineOf(key)?.isOpen ?? this.#model.get("folds")[key] ?? false;
  }

  #hover(key: string): void {
    if (key === this.#hovered) return;
    this.#hovered = key;
    this.#placeActions();
    this.#tell();
  }

  /** Puts the buttons into the line under the pointer, else into the one with the focus. */
  #placeActions(): void {
    const key = this.#lineOf(this.#hovered) ? this.#hovered : this.#active;
    const line = this.#lineOf(key);
    const view = line?.field ? this.#viewOf(key) : undefined;
    for (const { root } of this.#views) {
      root.classList.toggle("rw-message-picked", root === view?.root && (key === this.#hovered || this.#isFocused));
    }
    if (!line?.field || !view) {
      this.#actions.remove();
      return;
    }
    const { kind } = line.field.node;
    const isNumber = kind === "number" || kind === "flag";
    setHidden(this.#watch, !isNumber);
    setHidden(this.#plot, !isNumber || !this.#model.get("_plots") || lacksKernel(this.#model));
    const isWatched = this.#model.get("over_time").includes(line.field.path);
    set(this.#watch, "ariaPressed", String(isWatched));
    set(this.#watch, "title", isWatched ? "Draw it no more (w)" : "Draw it over the last seconds (w)");
    const code = this.#codeOf(line.field);
    const isCopied = this.#copied === code;
    set(this.#copy, "ariaPressed", String(isCopied));
    setText(this.#copy, isCopied ? "Copied" : this.#card.width < NARROW ? "Copy" : "Copy path");
    set(this.#copy, "title", `Copy ${code} (c)`);
    if (this.#actions.parentElement !== view.gap) view.gap.append(this.#actions);
  }

  get #isFocused(): boolean {
    return this.#tree.contains(document.activeElement);
  }

  #activate(key: string): void {
    if (!key || !this.#lineOf(key)) return;
    this.#active = key;
    for (const [i, { root }] of this.#views.entries()) {
      const isActive = this.#lines[i]?.key === key;
      root.tabIndex = isActive ? 0 : -1;
      const field = this.#lines[i]?.field;
      // A label on a line that changes all the time would be read all the time.
      root.ariaLabel = isActive && field ? toSpoken(field, root.classList.contains("rw-message-changed")) : null;
    }
    this.#placeActions();
    this.#tell();
  }

  #onClick(key: string, event: MouseEvent): void {
    if (event.target instanceof Element && event.target.closest("button")) return;
    const line = this.#lineOf(key);
    if (line) this.#focus(key);
    if (line?.asks) this.#ask(line.asks);
    else if (line && line.isOpen !== null) this.#fold(key, !line.isOpen);
    else if (!line && key) this.#fold(key, !this.#isOpen(key));
  }

  #focus(key: string): void {
    const view = this.#viewOf(key);
    if (!view) return;
    this.#hovered = "";
    this.#active = key;
    view.root.focus({ preventScroll: true });
    view.root.scrollIntoView({ block: "nearest" });
  }

  #fold(key: string, isOpen: boolean): void {
    const field = this.#lineOf(key)?.field;
    if (isOpen && field && isMissing(field)) this.#ask(field.path);
    setTraits(this.#model, { folds: { ...this.#model.get("folds"), [key]: isOpen } });
  }

  /** Requests a part from Python that is too large to be sent unasked. */
  #ask(path: string): void {
    const wanted = this.#model.get("_wanted");
    if (!wanted.includes(path)) setTraits(this.#model, { _wanted: [...wanted, path] });
  }

  #toggle(name: "rows" | "changes"): void {
    setTraits(this.#model, { [name]: !this.#model.get(name) });
  }

  /** The number of the line under the pointer, else of the one with the focus. */
  get #pickedNumber(): Field | null {
    const field = this.#lineOf(this.#lineOf(this.#hovered) ? this.#hovered : this.#active)?.field;
    return field && (field.node.kind === "number" || field.node.kind === "flag") ? field : null;
  }

  #askForPlot(): void {
    const field = this.#pickedNumber;
    if (!field) return;
    this.#model.send({ plot: field.path });
    this.#card.say([`asked for a plot of ${field.path}`]);
  }

  #toggleWatch(): void {
    const field = this.#pickedNumber;
    if (!field) return;
    const watched = this.#model.get("over_time");
    const isWatched = watched.includes(field.path);
    const over_time = isWatched ? watched.filter((path) => path !== field.path) : [...watched, field.path];
    setTraits(this.#model, { over_time });
    this.#card.say([`${field.path} is ${isWatched ? "no longer " : ""}drawn over time`]);
  }

  #codeOf(field: Field): string {
    const { keyed = false, recorded } = this.#about;
    if (recorded === undefined) return toCode(field, keyed);
    const seconds = Number((this.#stream.shown?.arrived ?? 0).toFixed(6));
    return toCode(field, keyed, `recording.message_at(${quoted(recorded)}, ${seconds}).message`);
  }

  async #copyPath(): Promise<void> {
    const field = this.#lineOf(this.#lineOf(this.#hovered) ? this.#hovered : this.#active)?.field;
    if (!field) return;
    const code = this.#codeOf(field);
    const isCopied = await copyText(code);
    clearTimeout(this.#timer);
    setHidden(this.#code, isCopied);
    this.#card.say([isCopied ? `copied ${code}` : "press Ctrl and C to copy"]);
    if (!isCopied) {
      this.#code.value = code;
      this.#code.focus({ preventScroll: true });
      this.#code.select();
      return;
    }
    this.#copied = code;
    this.#timer = setTimeout(() => {
      this.#copied = "";
      this.#card.drawNow();
    }, COPIED_MS);
    this.#card.drawNow();
  }

  #onKey(event: KeyboardEvent): void {
    if (!isPlain(event) || event.target instanceof HTMLButtonElement || this.#tree.hidden) return;
    const line = this.#lineOf(this.#active);
    const by = WALK[event.key];
    if (by !== undefined) this.#walk(by);
    else if (event.key === "ArrowRight" && line?.isOpen === false) this.#fold(line.key, true);
    else if (event.key === "ArrowRight" && line?.isOpen) this.#walk(1);
    else if (event.key === "ArrowLeft" && line?.isOpen) this.#fold(line.key, false);
    else if (event.key === "ArrowLeft" && line) this.#toParent(line);
    else if (event.key === "*" && line?.isOpen !== null) this.#unfoldAll(line);
    else if (event.key === "Enter" && line?.asks) this.#ask(line.asks);
    else if (event.key === "Enter" && line && line.isOpen !== null) this.#fold(line.key, !line.isOpen);
    else if (event.key === "Enter" && !this.#plot.hidden) this.#askForPlot();
    else if (event.key === "w" || event.key === "Enter") this.#toggleWatch();
    else if (event.key === "c") void this.#copyPath();
    else return;
    event.preventDefault();
  }

  #walk(by: number): void {
    const at = this.#lines.findIndex(({ key }) => key === this.#active);
    const next = this.#lines[Math.min(this.#lines.length - 1, Math.max(0, this.#isFocused ? at + by : at))];
    if (next) this.#focus(next.key);
  }

  #toParent({ key, depth }: TreeLine): void {
    const at = this.#lines.findIndex((line) => line.key === key);
    const parent = this.#lines
      .slice(0, at)
      .filter((line) => line.depth < depth)
      .at(-1);
    if (parent) this.#focus(parent.key);
  }

  /** Unfolds a line, and all messages below it that were sent. */
  #unfoldAll(line: TreeLine | undefined): void {
    const folds = { ...this.#model.get("folds") };
    const unfold = (field: Field) => {
      folds[field.path] = true;
      for (const child of field.children ?? []) if (child.children) unfold(child);
    };
    if (line?.field) unfold(line.field);
    setTraits(this.#model, { folds });
  }
}

/** Returns true if the content of a part has to be requested. */
function isMissing({ node, value }: Field): boolean {
  if (node.kind === "numbers") return (value as number[])[5] === -1 && ((value as number[])[0] ?? 0) <= 1000;
  return node.folded !== undefined;
}
