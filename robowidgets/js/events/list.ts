import { make, set, setHidden, setText } from "../shared/dom.ts";
import { on, onAbort } from "../shared/events.ts";
import { levelOf, type Row } from "./rows.ts";
import { describeRow, type Times, toLine, toTimes, toTimeText } from "./text.ts";

export const ROW = 24;

/** The content of the list. */
export interface Listing {
  rows: Row[];
  times: Times;
  /** Index of the row at the cursor; -1 without one. */
  current: number;
  /** Number of the unfolded row; null if all are folded. */
  open: number | null;
}

interface Line {
  root: HTMLElement;
  time: HTMLElement;
  sign: HTMLElement;
  word: HTMLElement;
  source: HTMLElement;
  text: HTMLElement;
  count: HTMLElement;
  more: HTMLElement;
  facts: HTMLElement;
  whole: HTMLElement;
  shown: Row | null;
}

/** Returns true if two listings look the same. */
function isAlike(a: Listing, b: Listing): boolean {
  const isSameTimes = a.times.start === b.times.start && a.times.span.join() === b.times.span.join();
  return isSameTimes && a.rows === b.rows && a.current === b.current && a.open === b.open;
}

/**
 * A list of rows that has only the rows in view in the page. The rows in view stick to the top of the scrolled box, so
 * that a saved picture of the card, which ignores scrolling, shows the same.
 */
export class List {
  readonly root = make("div", "rw-events-list");
  readonly #sizer = make("div", "rw-events-sizer");
  readonly #window = make("div", "rw-events-window");
  /** The lines in view in their order, then the hidden ones. */
  #lines: Line[] = [];
  #listing: Listing = { rows: [], times: { span: [], start: null }, current: -1, open: null };
  /** Pixels by which the open row is higher than other rows. */
  #extra = 0;
  #isPointedAt = false;
  #isLive = false;
  /** True while the list stays at its end as rows arrive. */
  #follows = true;

  /**
   * @param onPick called with a row that is clicked
   * @param onPoint called with the row under the pointer, or null
   */
  constructor(onPick: (row: Row) => void, onPoint: (row: Row | null) => void, signal: AbortSignal) {
    this.#sizer.append(this.#window);
    this.root.append(this.#sizer);
    on(this.root, "scroll", () => this.#onScroll(), signal);
    const observer = new ResizeObserver(() => this.#onResize());
    observer.observe(this.root);
    onAbort(signal, () => observer.disconnect());
    const rowOf = ({ target }: Event) => {
      const line = this.#lines.find(({ root }) => target instanceof Node && root.contains(target));
      return line?.shown ?? null;
    };
    on(this.root, "pointerenter", () => this.#setPointed(true), signal);
    on(this.root, "pointermove", (event) => event.pointerType !== "touch" && onPoint(rowOf(event)), signal);
    on(
      this.root,
      "pointerleave",
      () => {
        this.#setPointed(false);
        onPoint(null);
      },
      signal,
    );
    on(
      this.root,
      "click",
      (event) => {
        const row = rowOf(event);
        const isReading = event.target instanceof Element && event.target.closest(".rw-event-more") !== null;
        if (row && !isReading) onPick(row);
      },
      signal,
    );
  }

  /** True while rows must not move below the pointer. */
  get isPointedAt(): boolean {
    return this.#isPointedAt;
  }

  #setPointed(isPointedAt: boolean): void {
    this.#isPointedAt = isPointedAt;
    if (!isPointedAt && this.#isLive && this.#listing.current < 0) this.#follow();
  }

  /** @param isLive true if rows arrive at the end, where the list stays unless the user has scrolled away */
  update(listing: Listing, isLive: boolean): void {
    const before = this.#listing;
    const isSame = isLive === this.#isLive && isAlike(listing, before);
    this.#isLive = isLive;
    // Reading the scroll position forces a layout of the page, which an unchanged drawing must not wait for.
    if (isSame) return;
    this.#listing = listing;
    if (listing.open === null) this.#extra = 0;
    this.#layOut();
    if (this.#isPointedAt) return;
    if (isLive && listing.current < 0) this.#follow();
    else if (listing.current !== before.current || listing.rows !== before.rows) this.reveal(listing.current);
  }

  #follow(): void {
    if (this.#follows) this.root.scrollTop = this.root.scrollHeight;
  }

  #onResize(): void {
    this.#layOut();
    if (!this.#isPointedAt && this.#isLive && this.#listing.current < 0) this.#follow();
  }

  /** Scrolls just enough to bring a row into view. */
  reveal(index: number): void {
    if (index < 0) return;
    const { scrollTop, clientHeight } = this.root;
    const top = this.#topOf(index);
    const height = ROW + (this.#openIndex === index ? this.#extra : 0);
    if (top < scrollTop) this.root.scrollTop = top;
    else if (top + height > scrollTop + clientHeight)
      this.root.scrollTop = top + Math.min(height, clientHeight) - clientHeight;
    this.#layOut();
  }

  get #openIndex(): number {
    const { rows, open } = this.#listing;
    return open === null ? -1 : rows.findIndex(({ number }) => number === open);
  }

  #topOf(index: number): number {
    const open = this.#openIndex;
    return index * ROW + (open >= 0 && index > open ? this.#extra : 0);
  }

  #onScroll(): void {
    const { scrollTop, clientHeight, scrollHeight } = this.root;
    this.#follows = scrollTop + clientHeight >= scrollHeight - ROW / 2;
    this.#layOut();
  }

  #layOut(): void {
    const { rows } = this.#listing;
    const open = this.#openIndex;
    const { scrollTop, clientHeight } = this.root;
    const openTop = open < 0 ? Infinity : open * ROW;
    const above = scrollTop > openTop + ROW + this.#extra ? this.#extra : 0;
    const first = scrollTop > openTop && !above ? open : Math.max(0, Math.floor((scrollTop - above) / ROW));
    const offset = this.#topOf(first) - scrollTop;
    const count = Math.max(0, Math.min(rows.length - first, Math.ceil((clientHeight - offset) / ROW) + 1));
    this.#place(rows.slice(first, first + count), first);
    this.#window.style.transform = `translateY(${Math.round(offset)}px)`;
    const line = this.#lines[open - first];
    const extra = open >= first && line ? line.more.offsetHeight : this.#extra;
    this.#sizer.style.height = `${rows.length * ROW + (open < 0 ? 0 : extra)}px`;
    if (open >= 0 && extra !== this.#extra) {
      this.#extra = extra;
      this.#layOut();
    }
  }

  /**
   * Puts rows in order into the page. Each keeps its element while it is in view, so that a row does not move just
   * before a click.
   */
  #place(rows: Row[], first: number): void {
    const before = new Map(this.#lines.map((line) => [line.shown?.number, line]));
    const numbers = new Set(rows.map(({ number }) => number));
    const free = this.#lines.filter(({ shown }) => !shown || !numbers.has(shown.number));
    const lines = rows.map((row) => before.get(row.number) ?? free.pop() ?? this.#makeLine());
    let next = this.#window.firstChild;
    for (const [i, line] of lines.entries()) {
      if (line.root === next) next = next.nextSibling;
      else this.#window.insertBefore(line.root, next);
      setHidden(line.root, false);
      this.#fill(line, rows[i] as Row, first + i);
    }
    for (const line of free) {
      setHidden(line.root, true);
      line.root.ariaCurrent = "false";
      line.shown = null;
    }
    this.#lines = [...lines, ...free];
  }

  #fill(line: Line, row: Row, index: number): void {
    const { times, current, open } = this.#listing;
    line.shown = row;
    const level = levelOf(row);
    set(line.root.dataset, "level", level.word);
    set(line.root, "ariaCurrent", String(index === current));
    setText(line.time, toTimeText(row.seconds, times));
    setText(line.sign, level.sign);
    setText(line.word, level.word);
    setText(line.source, row.source || row.topic);
    setText(line.text, toLine(row));
    setText(line.count, toTimes(row));
    const isOpen = row.number === open;
    setHidden(line.more, !isOpen);
    setText(line.facts, isOpen ? describeRow(row, times) : "");
    setText(line.whole, isOpen ? row.text : "");
  }

  #makeLine(): Line {
    const part = (name: string) => make("span", `rw-event-${name}`);
    const [root, head, more] = [make("div", "rw-event"), make("div", "rw-event-line"), make("div", "rw-event-more")];
    const level = part("level");
    const line: Line = {
      root,
      more,
      time: part("time"),
      sign: part("sign"),
      word: part("word"),
      source: part("source"),
      text: part("text"),
      count: part("count"),
      facts: make("div", "rw-event-facts"),
      whole: make("div", "rw-event-whole"),
      shown: null,
    };
    level.append(line.sign, line.word);
    head.append(line.time, level, line.source, line.text, line.count);
    more.append(line.facts, line.whole);
    root.append(head, more);
    return line;
  }
}
