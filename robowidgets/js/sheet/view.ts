import { Card } from "../shared/card.ts";
import { CopyCode, copyText } from "../shared/copy.ts";
import { make, makeButton, setHidden, setText, zoomOf } from "../shared/dom.ts";
import { isPlain, on, onAbort } from "../shared/events.ts";
import { toOrdinal, toShortMetres } from "../shared/format.ts";
import { lacksKernel, type Model, NO_KERNEL, onChange, onMessage, setTraits } from "../shared/model.ts";
import { NameRow } from "../shared/naming.ts";
import { offerPng } from "../shared/png.ts";
import { perAnimationFrame, throttle } from "../shared/schedule.ts";
import type { Cut } from "./draw.ts";
import { toReason, toReasons, toShell } from "./odd.ts";
import {
  COLUMNS,
  type Column,
  cutOf,
  evenly,
  filtered,
  firstOfEach,
  type Moment,
  sorted,
  toCode,
  toMoments,
} from "./order.ts";
import type { Pictures } from "./pictures.ts";
import { type Item, Row, Tile } from "./tile.ts";
import type { OddFile, SheetTraits } from "./traits.ts";

const [TILE, ROW, PADDING] = [153, 26, 8];
const [GAP_X, GAP_Y] = [4, 10];
/** Rows of tiles, and of the table, that are visible at once. */
const [TILE_ROWS, TABLE_ROWS] = [3, 15];
/** Milliseconds of painting between two pictures of the page. */
const PAINT_MS = 8;
/** Milliseconds between two requests for pictures. */
const LOOK_MS = 100;
/** Milliseconds after which a kernel that has not answered is busy. */
const BUSY_MS = 700;
/** Greatest number of listed files that were not read whole. */
const MOST_ODD = 4;
/** Metres at which pictures are cut if no moment has a nearest thing. */
const FAR = 5;

const SORTS: readonly [Column, string][] = [
  ["nearest", "Nearest"],
  ["value", "Value"],
  ["time", "Time"],
  ["file", "File"],
];

const count = (number: number) => number.toLocaleString("en");

/** One view of a contact sheet. */
export class SheetView {
  readonly #model: Model<SheetTraits>;
  readonly #pictures: Pictures;
  readonly #card: Card;
  readonly #signal: AbortSignal;
  readonly #scroll = make("div", "rw-sheet-scroll");
  readonly #space = make("div", "rw-sheet-space");
  readonly #heads = make("div", "rw-sheet-row rw-sheet-heads");
  readonly #filters = make("div", "rw-sheet-filters");
  readonly #fields = new Map<Column, HTMLInputElement>();
  readonly #empty = make("div", "rw-empty");
  readonly #bar = make("div", "rw-sheet-bar");
  readonly #code = make("code", "rw-sheet-code");
  readonly #said = make("span", "rw-sheet-said");
  readonly #open: HTMLButtonElement;
  readonly #copy: CopyCode;
  readonly #label: HTMLButtonElement;
  readonly #name: NameRow;
  readonly #odd = make("div", "rw-sheet-odd");
  readonly #foot = [make("span", ""), make("span", "rw-sheet-legend")] as const;
  readonly #sorts = new Map<Column, HTMLButtonElement>();
  readonly #again: HTMLButtonElement;
  readonly #one: HTMLButtonElement;
  readonly #every: HTMLButtonElement;
  readonly #table: HTMLButtonElement;
  readonly #filter: HTMLButtonElement;
  readonly #fill: () => void;
  readonly #paint: () => void;
  readonly #look: () => void;
  #moments: Moment[] = [];
  /** The moments on show, in their order. */
  #order: Moment[] = [];
  #step = 1;
  /** By path, the number of moments of a file. */
  readonly #ofFile = new Map<string, number>();
  /** True if moments arrived after the last sorting. */
  #isUnsorted = false;
  #cut: Cut = { reach: FAR, inner: 1 };
  #columns = 1;
  #width = TILE;
  /** The items on the page, by their places in the order. */
  #items = new Map<number, Item>();
  #spare: Item[] = [];
  #pointed: Moment | null = null;
  #asked: string = "";
  #waits: number | null = null;
  /** The moment whose name the kernel has not kept yet, and that name, or "" to remove it. */
  #named: [number, string] | null = null;
  #isBusy = false;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #isTouch = false;

  constructor(model: Model<SheetTraits>, element: HTMLElement, pictures: Pictures, signal: AbortSignal) {
    this.#model = model;
    this.#pictures = pictures;
    this.#signal = signal;
    this.#card = new Card(element, "sheet", model, () => this.#draw(), signal);
    const { picture, footer, root, controls } = this.#card;
    picture.tabIndex = -1;
    picture.role = "none";
    this.#scroll.tabIndex = 0;
    this.#scroll.role = "listbox";
    this.#scroll.ariaLabel = "moments";
    this.#scroll.append(this.#space);
    picture.append(this.#filters, this.#heads, this.#scroll, this.#empty);
    this.#copy = new CopyCode(
      () => (this.#shown ? toCode(this.#shown) : ""),
      (words) => this.#card.say(words),
      signal,
    );
    this.#open = makeButton(
      "rw-sheet-named",
      "Open its recording below, at that moment (Enter)",
      () => this.#openShown(),
      signal,
      "Open here",
    );
    this.#label = makeButton("rw-sheet-named", "Give the span a name (L)", () => this.#askName(), signal, "Label");
    const naming = { onName: (name: string) => this.#sendName(name), onRemove: () => this.#sendName("") };
    this.#name = new NameRow("name of the span", naming, signal);
    const parts = [this.#code, this.#said, this.#label, this.#copy.row, this.#open, this.#copy.field, this.#name.root];
    this.#bar.append(...parts);
    footer.before(this.#bar, this.#odd);
    footer.append(...this.#foot);
    const sorts = make("span", "rw-sheet-sorts");
    sorts.append(make("span", "rw-sheet-by", "sort"));
    for (const [name, word] of SORTS) {
      const button = makeButton(
        "",
        `Sort by ${name}; again: the other way round`,
        () => this.#sortBy(name),
        signal,
        word,
      );
      this.#sorts.set(name, button);
      sorts.append(button);
    }
    this.#again = makeButton(
      "rw-sheet-named",
      "Sort in what came since",
      () => this.#sortAgain(),
      signal,
      "Sort again",
    );
    this.#one = makeButton(
      "rw-sheet-named",
      "Show the first of each file only",
      () => this.#flip("one_per_file"),
      signal,
      "One per file",
    );
    this.#every = makeButton(
      "rw-sheet-named",
      "Show an even choice that fills one screen",
      () => this.#flip("every"),
      signal,
      "Every",
    );
    this.#table = makeButton(
      "rw-sheet-named",
      "Show a table instead of pictures",
      () => this.#flip("rows"),
      signal,
      "Table",
    );
    this.#filter = makeButton("rw-sheet-named", "Filter by column (/)", () => this.#toggleFilters(), signal, "Filter");
    controls.append(sorts, this.#again, this.#one, this.#every, this.#table, this.#filter);
    offerPng(this.#card, model, signal);
    // Their accessible names are their texts.
    for (const button of root.querySelectorAll(".rw-sheet-sorts > button, .rw-sheet-named")) button.ariaLabel = null;
    this.#makeHeads();
    this.#makeFilters();
    this.#fill = perAnimationFrame(() => this.#place(), signal);
    this.#paint = perAnimationFrame(() => this.#paintSome(PAINT_MS), signal);
    this.#look = throttle(() => this.#askForPictures(), LOOK_MS, signal);
    onAbort(signal, () => clearTimeout(this.#timer));
    on(this.#scroll, "scroll", this.#fill, signal, { passive: true });
    on(this.#scroll, "pointerdown", (event) => this.#onDown(event), signal);
    on(this.#scroll, "pointermove", (event) => this.#onMove(event), signal);
    on(this.#scroll, "pointerleave", () => this.#point(null), signal);
    on(this.#scroll, "click", (event) => this.#onClick(event), signal);
    on(root, "keydown", (event) => this.#onKey(event), signal);
    onChange(model, ["_columns"], () => this.#onMoments(), signal);
    onChange(model, ["sort", "filters", "one_per_file", "every", "rows"], () => this.#sortAgain(), signal);
    onChange(
      model,
      ["picked", "false_finds", "labels", "_opened", "_status", "_done", "_total", "_unread", "condition"],
      this.#card.redraw,
      signal,
    );
    onMessage(
      model,
      ({ opened, labelled }: { opened?: number; labelled?: number }) => {
        if (opened !== undefined) this.#onOpened();
        if (labelled === this.#named?.[0]) this.#onNamed();
      },
      signal,
    );
    pictures.listen(() => {
      for (const item of this.#items.values()) item.isStale ||= !item.element.dataset.painted;
      this.#paint();
    }, signal);
    this.#onMoments();
  }

  /** The moment in the row below: the one under the pointer, else the kept one. */
  get #shown(): Moment | null {
    const picked = this.#model.get("picked");
    return this.#pointed ?? (picked === null ? null : (this.#moments[picked] ?? null));
  }

  get #isTable(): boolean {
    return this.#model.get("rows");
  }

  // -- data
  // ------------------------------------------------------------------------------------------------------------

  #onMoments(): void {
    const before = this.#moments.length;
    const model = this.#model;
    this.#moments = toMoments(model.get("_columns"), model.get("_files"), model.get("_topics"));
    this.#ofFile.clear();
    for (const { path } of this.#moments) this.#ofFile.set(path, (this.#ofFile.get(path) ?? 0) + 1);
    const reach = cutOf(this.#moments) ?? FAR;
    if (reach !== this.#cut.reach) {
      this.#cut = { reach, inner: toInner(reach) };
      this.#soil();
    }
    if (!before || this.#model.get("_done") === null) {
      this.#sortAgain();
      return;
    }
    // While a search goes on, nothing jumps: new ones stand at the end.
    const kept = this.#order.map(({ number }) => this.#moments[number]).filter((one) => one !== undefined);
    const more = filtered(this.#moments.slice(before), this.#model.get("filters"));
    this.#order = this.#model.get("every") || this.#model.get("one_per_file") ? kept : [...kept, ...more];
    this.#isUnsorted ||= this.#moments.length > before;
    this.#forget();
    this.#card.redraw();
  }

  #sortAgain(): void {
    const model = this.#model;
    const all = sorted(filtered(this.#moments, model.get("filters")), model.get("sort"));
    const chosen = model.get("one_per_file") ? firstOfEach(all) : all;
    this.#measure();
    const even = evenly(chosen, this.#columns * (this.#isTable ? TABLE_ROWS : TILE_ROWS));
    this.#step = even.step;
    this.#order = model.get("every") ? even.chosen : chosen;
    this.#isUnsorted = false;
    this.#forget();
    this.#scroll.scrollTop = 0;
    this.#card.redraw();
  }

  // -- drawing -------------------------------------------------------------------------------------------------------

  #draw(): void {
    const [done, total, odd] = [this.#model.get("_done"), this.#model.get("_total"), this.#model.get("_unread")];
    const unread = odd.filter((file) => !file.is_read).length;
    this.#measure();
    this.#soil();
    this.#space.style.height = `${this.#height}px`;
    this.#scroll.style.height = `${Math.min(this.#height, this.#most)}px`;
    // For a picture of the card: a copy of it is not scrolled.
    this.#card.root.style.setProperty("--rw-scrolled", `${this.#scroll.scrollTop}px`);
    setHidden(this.#heads, !this.#isTable);
    this.#heads.style.paddingRight = `${ROW / 2 + this.#scroll.offsetWidth - this.#scroll.clientWidth}px`;
    this.#place();
    if (this.#card.size.ratio !== devicePixelRatio * zoomOf(this.#card.picture))
      this.#paintSome(Number.POSITIVE_INFINITY);
    const all = this.#moments.length;
    setHidden(this.#empty, this.#order.length > 0);
    const never = unread && unread === total ? "no file searched" : "never";
    setText(this.#empty, all ? "none passes the filters" : done === null ? never : "nothing yet");
    this.#card.updateFrame([], "note");
    const files = this.#ofFile.size;
    const isFalse = this.#model.get("false_finds").length;
    const found =
      done === null
        ? `${count(all)} in ${count(files)} of ${toFiles(total - unread)}`
        : `${count(all)} so far, ${count(done)} of ${toFiles(total)}`;
    const left = done === null && unread ? [`${count(unread)} not searched`] : [];
    this.#card.updateFacts([
      found,
      ...left,
      ...(isFalse ? [`${count(isFalse)} false`] : []),
      this.#model.get("condition"),
    ]);
    this.#drawControls();
    this.#drawBar();
    this.#drawOdd(odd);
    this.#drawFoot();
  }

  #drawControls(): void {
    const model = this.#model;
    const sort = model.get("sort");
    const by = sort.replace(/^-/, "");
    for (const [name, button] of this.#sorts) {
      const isPressed = name === by;
      button.ariaPressed = String(isPressed);
      const word = SORTS.find(([one]) => one === name)?.[1] ?? "";
      setText(button, isPressed && sort.startsWith("-") ? `${word} ↓` : word);
    }
    for (const head of this.#heads.querySelectorAll<HTMLElement>("[data-column]")) {
      const isPressed = head.dataset.column === by;
      head.ariaSort = isPressed ? (sort.startsWith("-") ? "descending" : "ascending") : "none";
    }
    this.#one.ariaPressed = String(model.get("one_per_file"));
    this.#every.ariaPressed = String(model.get("every"));
    this.#table.ariaPressed = String(this.#isTable);
    // An empty column takes no room.
    for (const name of ["nearest", "index", "value"] as const) {
      const isThere = this.#moments.some((moment) => moment[name] !== null);
      this.#card.root.classList.toggle(`rw-sheet-no-${name}`, !isThere);
      const sortBy = this.#sorts.get(name);
      if (sortBy) setHidden(sortBy, !isThere);
      const field = this.#fields.get(name)?.parentElement;
      if (field) setHidden(field, !isThere);
    }
    const isFiltered = Object.values(model.get("filters")).some(Boolean);
    this.#filter.ariaPressed = String(isFiltered || !this.#filters.hidden);
    setHidden(this.#again, !this.#isUnsorted);
    setHidden(this.#every, this.#step === 1 && !model.get("every"));
    setText(this.#every, `Every ${toOrdinal(this.#step)}`);
  }

  #drawBar(): void {
    const moment = this.#shown;
    const status = this.#model.get("_status");
    setText(this.#code, moment ? toCode(moment) : "");
    this.#code.title = this.#code.textContent;
    const same = moment ? (this.#ofFile.get(moment.path) ?? 1) - 1 : 0;
    const held = moment?.held ? `held ${moment.held < 10 ? moment.held.toFixed(2) : moment.held.toFixed(0)} s` : "";
    const name = this.#model.get("labels")[moment?.number ?? -1];
    const more = same > 0 ? `${count(same)} more in this file` : "";
    const words = this.#pictures.get(moment?.number ?? -1)?.words ?? "";
    const facts = [name ? `“${name}”` : "", moment?.nearest === null ? words : "", held, more]
      .filter(Boolean)
      .join(", ");
    const waits = this.#waits !== null;
    const [, given] = this.#named ?? [];
    const isKept = given ? `\u201c${given}\u201d is kept` : "the name is taken away";
    const does = waits ? "it opens" : isKept;
    const isAsked = waits || this.#named !== null;
    const busy = isAsked && this.#isBusy ? `the kernel is busy: ${does} when the cell ends` : waits ? "opens …" : "";
    setText(this.#said, busy || status || (moment ? facts : "click a moment to open it, x marks a false find"));
    this.#said.classList.toggle("rw-error", Boolean(!busy && status));
    setHidden(this.#copy.row, !moment);
    const isAlone = lacksKernel(this.#model);
    setHidden(this.#open, !moment);
    setHidden(this.#label, !moment || isAlone);
  }

  #drawOdd(odd: OddFile[]): void {
    setHidden(this.#odd, odd.length === 0);
    const key = odd.map(({ path, problem }) => path + problem).join("\n");
    if (this.#odd.dataset.key === key) return;
    this.#odd.dataset.key = key;
    const heading = make("div", "rw-sheet-odd-row");
    const files = odd.length === 1 ? "1 file" : `${count(odd.length)} files`;
    heading.append(
      make("b", "", `${files} could not be read whole`),
      make("span", "rw-sheet-why", `counted as searched only as far as ${odd.length === 1 ? "it goes" : "they go"}`),
    );
    const rows = odd.slice(0, odd.length > MOST_ODD + 1 ? MOST_ODD : MOST_ODD + 1).map((file) => this.#makeOdd(file));
    const left = odd.slice(rows.length);
    this.#odd.replaceChildren(heading, ...rows);
    if (left.length) this.#odd.append(make("div", "rw-sheet-odd-row rw-sheet-why", toReasons(left)));
  }

  #makeOdd(file: OddFile): HTMLElement {
    const { path, name, is_read } = file;
    const row = make("div", "rw-sheet-odd-row");
    row.title = path;
    const why = make("span", "rw-sheet-why", toReason(file));
    const [word, command] = is_read ? ["Repair a copy", "repair"] : ["Look at it", "doctor"];
    const line = `robowidgets ${command} ${toShell(path)}`;
    const onClick = async () => setText(button, (await copyText(line)) ? "Command copied" : line);
    const button = makeButton("rw-sheet-next", `Copy the command: ${line}`, onClick, this.#signal, word);
    button.ariaLabel = null;
    row.append(make("span", "rw-sheet-broken"), make("b", "", name), why, button);
    return row;
  }

  #drawFoot(): void {
    const [shown, all] = [this.#order.length, this.#moments.length];
    const choice = this.#model.get("every") && this.#step > 1 ? `: every ${toOrdinal(this.#step)}` : "";
    const moments = all === 1 ? "1 moment" : `${count(all)} moments`;
    const parts = [shown === all ? moments : `${count(shown)} of ${moments}${choice}`];
    const hasRays = this.#moments.some(({ nearest }) => nearest !== null);
    const { reach, inner } = this.#cut;
    if (hasRays && !this.#isTable) {
      parts.push(`each cut to the nearest ${toShortMetres(reach)}, inner arc ${toShortMetres(inner)}`);
    }
    setText(this.#foot[0], parts.join(" · "));
    const [, legend] = this.#foot;
    setHidden(legend, this.#isTable || !hasRays);
    if (!legend.childElementCount) {
      for (const [sign, words] of [
        ["reading", "reading"],
        ["lit", "behind it: the condition holds for it"],
      ] as const) {
        legend.append(make("i", `rw-sheet-sign rw-sheet-${sign}`), make("span", "", words));
      }
    }
  }

  #measure(): void {
    const width = this.#scroll.clientWidth;
    const room = width - 2 * PADDING;
    this.#columns = this.#isTable ? 1 : Math.max(2, Math.floor((room + GAP_X) / (TILE + GAP_X)));
    this.#width = this.#isTable ? width : Math.floor((room + GAP_X) / this.#columns) - GAP_X;
  }

  /** Pixels from one row to the next. */
  get #pitch(): number {
    return this.#isTable ? ROW : TILE + GAP_Y;
  }

  get #above(): number {
    return this.#isTable ? 0 : PADDING;
  }

  /** Height of all rows. */
  get #height(): number {
    const rows = Math.ceil(this.#order.length / this.#columns);
    return Math.max(this.#isTable ? 4 * ROW : TILE, rows * this.#pitch) + 2 * this.#above - (this.#isTable ? 0 : GAP_Y);
  }

  /** Number of moments that are visible at once. */
  get #most(): number {
    return this.#isTable ? TABLE_ROWS * ROW : TILE_ROWS * (TILE + GAP_Y) - GAP_Y + 2 * PADDING;
  }

  /** Places in the order of the first visible moment, and after the last one. */
  #seen(spare = 0): [number, number] {
    const { scrollTop, clientHeight } = this.#scroll;
    const first = Math.floor((scrollTop - this.#above) / this.#pitch) - spare;
    const last = Math.ceil((scrollTop - this.#above + clientHeight) / this.#pitch) + spare;
    return [Math.max(0, first * this.#columns), Math.min(this.#order.length, last * this.#columns)];
  }

  /** Brings visible items to their places, and removes the others. */
  #place(): void {
    const [first, stop] = this.#seen(1);
    for (const [place, item] of this.#items) {
      if (place >= first && place < stop) continue;
      this.#items.delete(place);
      this.#spare.push(item);
    }
    const [picked, opened] = [this.#model.get("picked"), this.#model.get("_opened")];
    const wrong = new Set(this.#model.get("false_finds"));
    const labels = this.#model.get("labels");
    const total = this.#order.length;
    for (let place = first; place < stop; place++) {
      const moment = this.#order[place] as Moment;
      const there = this.#items.get(place);
      const item = there ?? this.#spare.pop() ?? (this.#isTable ? new Row() : new Tile());
      if (!there) {
        this.#items.set(place, item);
        if (!item.element.parentElement) this.#space.append(item.element);
      }
      const { number } = moment;
      item.show(moment, {
        place,
        count: total,
        isPicked: number === picked,
        isFalse: wrong.has(number),
        isOpen: number === opened,
        label: labels[number] ?? "",
      });
      if (item.isStale) delete item.element.dataset.painted;
      item.element.id ||= `rw-sheet-${Math.random().toString(36).slice(2)}`;
      const [column, row] = [place % this.#columns, Math.floor(place / this.#columns)];
      const x = this.#isTable ? 0 : PADDING + column * (this.#width + GAP_X);
      item.place(x, this.#above + row * this.#pitch, this.#width, this.#isTable ? ROW : TILE);
    }
    for (const item of this.#spare) if (item.moment) item.putAside();
    const at = [...this.#items.values()].find(({ moment }) => moment?.number === picked);
    const active = at?.element.id ?? "";
    if (this.#scroll.getAttribute("aria-activedescendant") !== active) {
      this.#scroll.setAttribute("aria-activedescendant", active);
    }
    this.#paint();
    this.#look();
  }

  /** Paints items for some milliseconds, and goes on before the next picture of the page. */
  #paintSome(milliseconds: number): void {
    const until = performance.now() + milliseconds;
    const { theme, size } = this.#card;
    const surface = { width: this.#width - 2, height: TILE - 2, ratio: size.ratio };
    for (const item of this.#items.values()) {
      if (!item.isStale || !item.moment) continue;
      if (performance.now() > until) {
        this.#paint();
        return;
      }
      const picture = this.#pictures.get(item.moment.number);
      item.paint(picture, this.#cut, surface, theme);
      item.isStale = false;
      if (picture) item.element.dataset.painted = picture.form;
    }
    if (this.#shown) this.#drawBar();
  }

  /** Marks all items to be painted again. */
  #soil(): void {
    for (const item of this.#items.values()) item.isStale = true;
  }

  /** Removes all items: other moments are at their places now. */
  #forget(): void {
    for (const item of [...this.#items.values(), ...this.#spare]) item.element.remove();
    this.#items.clear();
    this.#spare = [];
  }

  /** Requests the visible pictures that are missing; each request replaces the previous one. */
  #askForPictures(): void {
    if (!this.#scroll.clientHeight || lacksKernel(this.#model)) return;
    const [first, stop] = this.#seen();
    const numbers = this.#order.slice(first, stop).map(({ number }) => number);
    const missing = numbers.filter((number) => !this.#pictures.get(number));
    const key = missing.join();
    if (!missing.length || key === this.#asked) return;
    this.#asked = key;
    this.#model.send({ look: missing });
  }

  // -- actions of the user
  // -----------------------------------------------------------------------------------------------

  #flip(name: "one_per_file" | "every" | "rows"): void {
    setTraits(this.#model, { [name]: !this.#model.get(name) });
  }

  #sortBy(name: Column): void {
    setTraits(this.#model, { sort: this.#model.get("sort") === name ? `-${name}` : name });
  }

  #makeHeads(): void {
    for (const { name, head, isNumber } of COLUMNS) {
      const cell = make("span", `rw-sheet-cell rw-sheet-of-${name}${isNumber ? " rw-sheet-number" : ""}`);
      cell.role = "columnheader";
      cell.dataset.column = name;
      const button = makeButton("rw-sheet-head", `Sort by ${head}`, () => this.#sortBy(name), this.#signal, head);
      button.ariaLabel = null;
      cell.append(button);
      this.#heads.append(cell);
    }
    this.#heads.append(make("span", "rw-sheet-cell rw-sheet-words", "words"));
  }

  #makeFilters(): void {
    this.#filters.hidden = true;
    const change = throttle(() => this.#setFilters(), 150, this.#signal);
    for (const { name, head, isNumber } of COLUMNS) {
      const label = make("label", "rw-sheet-filter", head);
      const field = make("input", "rw-field");
      field.type = "search";
      field.placeholder = isNumber ? "< 0.2" : "any";
      field.title = isNumber ? 'A part of it, or "< 0.2", "0.1 to 0.2"' : "A part of it";
      field.value = this.#model.get("filters")[name] ?? "";
      if (field.value) this.#filters.hidden = false;
      on(field, "input", change, this.#signal);
      on(field, "keydown", (event) => this.#onFilterKey(event), this.#signal);
      label.append(field);
      this.#fields.set(name, field);
      this.#filters.append(label);
    }
  }

  #setFilters(): void {
    const filters: Record<string, string> = {};
    for (const [name, { value }] of this.#fields) if (value.trim()) filters[name] = value;
    setTraits(this.#model, { filters });
  }

  #toggleFilters(): void {
    this.#filters.hidden = !this.#filters.hidden;
    if (this.#filters.hidden) {
      for (const field of this.#fields.values()) field.value = "";
      this.#setFilters();
      this.#scroll.focus({ preventScroll: true });
    } else this.#fields.get("file")?.focus();
    this.#card.redraw();
  }

  #onFilterKey(event: KeyboardEvent): void {
    event.stopPropagation();
    if (event.key === "Escape") this.#toggleFilters();
    else if (event.key === "Enter") this.#scroll.focus({ preventScroll: true });
  }

  #momentAt(target: EventTarget | null): Moment | null {
    const item = target instanceof Element ? target.closest<HTMLElement>(".rw-sheet-item") : null;
    return item ? (this.#moments[Number(item.dataset.number)] ?? null) : null;
  }

  #onDown(event: PointerEvent): void {
    this.#isTouch = event.pointerType === "touch";
  }

  #onMove(event: PointerEvent): void {
    if (event.pointerType !== "touch") this.#point(this.#momentAt(event.target));
  }

  #point(moment: Moment | null): void {
    if (moment === this.#pointed) return;
    this.#pointed = moment;
    this.#copy.reset();
    this.#drawBar();
  }

  /** A click keeps a moment and opens it; a finger only keeps it, so that it can look first. */
  #onClick(event: MouseEvent): void {
    const moment = this.#momentAt(event.target);
    if (!moment) return;
    this.#pick(moment);
    if (!this.#isTouch) this.#openShown();
  }

  #pick(moment: Moment): void {
    setTraits(this.#model, { picked: moment.number });
    this.#drawBar();
  }

  #openShown(): void {
    const moment = this.#shown;
    if (!moment) return;
    if (lacksKernel(this.#model)) {
      setText(this.#said, NO_KERNEL);
      return;
    }
    if (moment.number !== this.#model.get("picked")) this.#pick(moment);
    this.#waits = moment.number;
    this.#model.send({ open: moment.number });
    this.#wait();
  }

  /** Shows after a while that the kernel is busy, if it has not answered. */
  #wait(): void {
    this.#isBusy = false;
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => {
      this.#isBusy = this.#waits !== null || this.#named !== null;
      this.#drawBar();
    }, BUSY_MS);
    this.#drawBar();
  }

  /** Asks for the name of the moment that is shown, which is kept meanwhile. */
  #askName(): void {
    const moment = this.#shown;
    if (!moment) return;
    if (lacksKernel(this.#model)) {
      setText(this.#said, NO_KERNEL);
      return;
    }
    this.#pick(moment);
    const labels = this.#model.get("labels");
    this.#name.open("", labels[moment.number] ?? "", Object.values(labels));
  }

  #sendName(name: string): void {
    const picked = this.#model.get("picked");
    if (picked === null) return;
    this.#named = [picked, name];
    this.#model.send({ label: this.#named });
    this.#wait();
  }

  #onNamed(): void {
    const [number, name] = this.#named ?? [0, ""];
    this.#named = null;
    // Nothing is lost: the text that could not be kept stands in the row again.
    if (this.#model.get("_status") && name && !this.#name.isOpen) {
      this.#name.open("", this.#model.get("labels")[number] ?? "", [], name);
    } else this.#card.say([name ? `named ${name}` : "the name is taken away"]);
    this.#card.redraw();
  }

  #onOpened(): void {
    this.#waits = null;
    this.#isBusy = false;
    clearTimeout(this.#timer);
    const moment = this.#moments[this.#model.get("_opened") ?? -1];
    if (moment && !this.#model.get("_status"))
      this.#card.say([`opened ${moment.file} at ${moment.time.toFixed(1)} seconds`]);
    this.#card.redraw();
  }

  #toggleFalse(): void {
    const moment = this.#shown;
    if (!moment) return;
    const there = this.#model.get("false_finds");
    const { number } = moment;
    const isFalse = there.includes(number);
    setTraits(this.#model, { false_finds: isFalse ? there.filter((one) => one !== number) : [...there, number] });
    this.#card.say([isFalse ? "no false find" : "false find"]);
  }

  #onKey(event: KeyboardEvent): void {
    if (!isPlain(event) || event.target instanceof HTMLInputElement) return;
    const walks: Record<string, number> = {
      ArrowRight: 1,
      ArrowLeft: -1,
      ArrowDown: this.#columns,
      ArrowUp: -this.#columns,
      PageDown: this.#columns * (this.#isTable ? TABLE_ROWS : TILE_ROWS),
      PageUp: -this.#columns * (this.#isTable ? TABLE_ROWS : TILE_ROWS),
      Home: Number.NEGATIVE_INFINITY,
      End: Number.POSITIVE_INFINITY,
    };
    const onItems = event.target === this.#scroll;
    const by = onItems ? walks[event.key] : undefined;
    if (by !== undefined) this.#walk(by);
    else if (event.key === "Enter" && onItems) this.#openShown();
    else if (event.key === "c") this.#copy.copy();
    else if (event.key === "x") this.#toggleFalse();
    else if (event.key === "l") this.#askName();
    else if (event.key === "/") {
      if (this.#filters.hidden) this.#toggleFilters();
      else this.#fields.get("file")?.focus();
    } else if (event.key === "Escape" && this.#model.get("picked") !== null) {
      setTraits(this.#model, { picked: null });
    } else return;
    event.preventDefault();
    event.stopPropagation();
  }

  #walk(by: number): void {
    const picked = this.#model.get("picked");
    const here = this.#order.findIndex(({ number }) => number === picked);
    const last = this.#order.length - 1;
    const moment = this.#order[here < 0 ? 0 : Math.min(last, Math.max(0, here + by))];
    if (!moment) return;
    this.#pointed = null;
    this.#copy.reset();
    this.#pick(moment);
    this.#scrollTo(this.#order.indexOf(moment));
  }

  #scrollTo(place: number): void {
    const top = this.#above + Math.floor(place / this.#columns) * this.#pitch;
    const bottom = top + (this.#isTable ? ROW : TILE);
    const { scrollTop, clientHeight } = this.#scroll;
    if (top < scrollTop) this.#scroll.scrollTop = top - this.#above;
    else if (bottom > scrollTop + clientHeight) this.#scroll.scrollTop = bottom + this.#above - clientHeight;
    this.#fill();
  }
}

/** Metres of the inner arc: about a third of the reach, a round number. */
function toInner(reach: number): number {
  const power = 10 ** Math.floor(Math.log10(reach / 3));
  const factor = [5, 2, 1].find((one) => one * power <= (reach / 3) * 1.001) ?? 1;
  return Number((factor * power).toPrecision(3));
}

function toFiles(number: number): string {
  return `${count(number)} ${number === 1 ? "file" : "files"}`;
}
