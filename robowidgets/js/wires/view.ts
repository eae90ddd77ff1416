import type { Point } from "../shared/box.ts";
import { isDragged, make, makeButton, pointIn, set, setHidden, setLabel, setText } from "../shared/dom.ts";
import { isPlain, on } from "../shared/events.ts";
import { toMany } from "../shared/format.ts";
import { lacksKernel, type Model, onChange, setTraits } from "../shared/model.ts";
import { SampleCard } from "../shared/sample_card.ts";
import { watchSeen } from "../shared/seen.ts";
import type { Stream } from "../shared/stream.ts";
import { Board } from "./board.ts";
import { around, type Graph, type Item, toGraph } from "./graph.ts";
import { beside, type Placed, place } from "./layout.ts";
import { fitted, type Sight, scaled, shifted, whole } from "./sight.ts";
import type { WiresTraits } from "./traits.ts";
import type { WiringFrame } from "./wiring.ts";
import { describe } from "./words.ts";

const [LEAST_HEIGHT, MOST_HEIGHT, PADDING] = [150, 420, 12];
const STEP = 1.3;
/** Change in pixels of a card's width after which its boxes are placed again. */
const ROWS_STEP = 40;
const HINT = "point at a box to see its wires, click to keep it";
const ARROWS: Record<string, [number, number]> = {
  ArrowRight: [1, 0],
  ArrowLeft: [-1, 0],
  ArrowDown: [0, 1],
  ArrowUp: [0, -1],
};
const NOTHING: Graph = { items: new Map(), links: [], plumbing: 0, filtered: 0 };

/** One view of the wires: their picture, and below it the facts about a box. */
export class WiresView {
  readonly #model: Model<WiresTraits>;
  readonly #stream: Stream<WiringFrame>;
  readonly #card: SampleCard;
  readonly #board = new Board();
  readonly #empty = make("div", "rw-empty");
  readonly #filter = make("input", "rw-field rw-wires-filter");
  readonly #plumbing: HTMLButtonElement;
  readonly #foot = make("div", "rw-wires-foot");
  readonly #heading = make("div", "rw-wires-heading");
  readonly #name = make("b", "rw-wires-name");
  readonly #facts = make("span", "");
  readonly #lines = [make("div", "rw-wires-line"), make("div", "rw-wires-line")];
  readonly #act: HTMLButtonElement;
  readonly #text = make("canvas", "").getContext("2d");
  #graph = NOTHING;
  #placed: Placed | null = null;
  #key = "";
  #sight: Sight = { scale: 1, x: 0, y: 0 };
  /** True after the user zoomed or moved: another graph then does not change the sight. */
  #isMoved = false;
  #pointed: string | null = null;
  #picked: string | null = null;
  #reached: string | null = null;
  #press: { at: Point; sight: Sight; drags: boolean } | null = null;

  constructor(model: Model<WiresTraits>, element: HTMLElement, stream: Stream<WiringFrame>, signal: AbortSignal) {
    this.#model = model;
    this.#stream = stream;
    this.#card = new SampleCard(element, "wires", model, stream, () => this.#draw(), signal);
    const { picture, footer, root } = this.#card;
    picture.append(this.#board.root, this.#empty);
    this.#act = makeButton("rw-wires-act", "", () => this.#onAct(), signal);
    this.#heading.append(this.#name, this.#facts);
    this.#foot.append(this.#heading, ...this.#lines, this.#act);
    footer.append(this.#foot);
    this.#filter.type = "search";
    this.#filter.placeholder = "filter";
    this.#filter.ariaLabel = "Show what has this text in its name, and what is wired to it (/)";
    this.#filter.title = this.#filter.ariaLabel;
    const toggle = () => setTraits(model, { infrastructure: !model.get("infrastructure") });
    this.#plumbing = makeButton(
      "rw-wires-plumbing",
      "Show what every node has, such as /rosout",
      toggle,
      signal,
      "Infrastructure",
    );
    const farther = makeButton("rw-zoom", "Zoom out (\u2212)", () => this.#zoom(1 / STEP), signal, "\u2212");
    const closer = makeButton("rw-zoom", "Zoom in (+)", () => this.#zoom(STEP), signal, "+");
    const fit = makeButton("rw-wires-fit", "Show all of it (0, double click)", () => this.#showAll(), signal, "Fit");
    this.#card.addControls(this.#filter, this.#plumbing, farther, closer, fit);
    on(this.#filter, "input", () => setTraits(model, { filter: this.#filter.value }), signal);
    onChange(model, ["filter", "infrastructure", "unfolded", "_can_open"], this.#card.redraw, signal);
    on(picture, "pointerdown", (event) => this.#onPress(event), signal);
    on(picture, "pointermove", (event) => this.#onMove(event), signal);
    on(picture, "pointerup", (event) => this.#onRelease(event), signal);
    on(picture, "pointercancel", () => this.#endPress(), signal);
    on(picture, "pointerleave", () => this.#point(null), signal);
    on(picture, "dblclick", (event) => this.#board.keyOf(event.target) === null && this.#showAll(), signal);
    on(picture, "wheel", (event) => this.#onWheel(event), signal, { passive: false });
    on(picture, "focusin", (event) => this.#onFocus(event), signal);
    on(root, "keydown", (event) => this.#onKey(event), signal);
    // While the picture is not visible, the robot gets no requests for it.
    watchSeen(root, (isSeen) => !lacksKernel(model) && model.send({ look: isSeen }), signal);
  }

  #draw(): void {
    const wiring = this.#stream.shown;
    const model = this.#model;
    const filter = model.get("filter");
    if (this.#filter.value !== filter) this.#filter.value = filter;
    const infrastructure = model.get("infrastructure");
    this.#graph = wiring ? toGraph(wiring, { filter, infrastructure, unfolded: model.get("unfolded") }) : NOTHING;
    const { items, plumbing } = this.#graph;
    const nodes = wiring?.nodes.length ?? 0;
    const counts = wiring ? [nodes ? toMany(nodes, "node") : "", toMany(wiring.wires.length, "topic")] : [];
    this.#card.update(counts, "list of topics", false);
    set(this.#plumbing, "ariaPressed", String(infrastructure));
    setHidden(this.#plumbing, !plumbing && !infrastructure);
    setText(this.#plumbing, plumbing ? `Infrastructure ${plumbing}` : "Infrastructure");
    setHidden(this.#empty, items.size > 0);
    setText(this.#empty, this.#whyEmpty(wiring));
    this.#place();
    this.#board.update(this.#graph);
    this.#mark();
  }

  #whyEmpty(wiring: WiringFrame | null): string {
    if (!wiring) return this.#card.waiting("list of topics");
    if (this.#model.get("filter")) return "nothing has this text in its name";
    return this.#model.get("_source").status || "no topic yet";
  }

  /** Places the boxes again if boxes or wires have changed. */
  #place(): void {
    const { size, theme, picture, noticeHeight } = this.#card;
    const { items, links } = this.#graph;
    // Topics without wires stand in rows, which are shorter in a narrow card.
    const step = Math.round(size.width / ROWS_STEP);
    const key = [theme.font, step, ...items.keys(), ...links.map((link) => link.join())].join("\n");
    const measure = (text: string) => {
      if (!this.#text) return 7 * text.length;
      this.#text.font = `600 12px ${theme.font}`;
      return this.#text.measureText(text).width;
    };
    const isNew = key !== this.#key || !this.#placed;
    if (isNew) {
      this.#key = key;
      this.#placed = place(this.#graph, measure, Math.max(1, size.width - 2 * PADDING));
      this.#board.draw(this.#placed, this.#graph);
    }
    if (!this.#placed) return;
    const { height } = fitted(this.#placed, { width: size.width - 2 * PADDING, height: Infinity }) && this.#placed;
    const scale = fitted(this.#placed, { width: size.width - 2 * PADDING, height: MOST_HEIGHT }).scale;
    const wished = Math.min(
      MOST_HEIGHT,
      Math.max(LEAST_HEIGHT, Math.ceil(height * scale) + 2 * PADDING + noticeHeight),
    );
    picture.style.setProperty("--rw-wires-height", `${wished}px`);
    if (!this.#isMoved) this.#sight = this.#inRoom(fitted(this.#placed, this.#room));
    this.#show();
  }

  /** The room for the picture. */
  get #room() {
    const { size, noticeHeight } = this.#card;
    return { width: size.width - 2 * PADDING, height: size.height - 2 * PADDING - noticeHeight };
  }

  #inRoom(sight: Sight): Sight {
    return { ...sight, x: sight.x + PADDING, y: sight.y + PADDING + this.#card.noticeHeight };
  }

  #show(): void {
    const { scale, x, y } = this.#sight;
    this.#board.root.style.transform = `translate(${Math.round(x)}px, ${Math.round(y)}px) scale(${scale})`;
  }

  #showAll(): void {
    if (!this.#placed) return;
    this.#isMoved = false;
    this.#sight = this.#inRoom(whole(this.#placed, this.#room));
    this.#isMoved = this.#sight.scale < fitted(this.#placed, this.#room).scale;
    this.#show();
  }

  #zoom(factor: number, at?: Point): void {
    const { width, height } = this.#card.size;
    this.#isMoved = true;
    this.#sight = scaled(this.#sight, factor, at ?? { x: width / 2, y: height / 2 });
    this.#show();
  }

  #onWheel(event: WheelEvent): void {
    if (!event.ctrlKey || !event.deltaY) return;
    event.preventDefault();
    this.#zoom(event.deltaY < 0 ? STEP : 1 / STEP, pointIn(this.#card.picture, event));
  }

  #onPress(event: PointerEvent): void {
    if (event.button === 0) this.#press = { at: pointIn(this.#card.picture, event), sight: this.#sight, drags: false };
  }

  #onMove(event: PointerEvent): void {
    const press = this.#press;
    if (!press || !this.#placed) {
      this.#point(this.#board.keyOf(event.target));
      return;
    }
    const at = pointIn(this.#card.picture, event);
    if (!press.drags && !isDragged(press.at, at)) return;
    if (!press.drags) this.#card.picture.setPointerCapture(event.pointerId);
    press.drags = true;
    this.#isMoved = true;
    const by = { x: at.x - press.at.x, y: at.y - press.at.y };
    this.#sight = shifted(press.sight, by, this.#placed, this.#card.size);
    this.#card.picture.classList.add("rw-wires-drags");
    this.#show();
  }

  #onRelease(event: PointerEvent): void {
    const press = this.#press;
    this.#endPress();
    if (press && !press.drags) this.#pick(this.#board.keyOf(event.target));
  }

  #endPress(): void {
    this.#press = null;
    this.#card.picture.classList.remove("rw-wires-drags");
  }

  #onFocus(event: FocusEvent): void {
    const key = this.#board.keyOf(event.target);
    if (key === null) return;
    this.#reached = key;
    this.#point(key);
    const item = this.#graph.items.get(key);
    if (item) this.#reveal(key);
  }

  /** Moves the picture so that a box is in view. */
  #reveal(key: string): void {
    const box = this.#placed?.boxes.get(key);
    if (!box || !this.#placed) return;
    const { scale, x, y } = this.#sight;
    const { width, height } = this.#card.size;
    const into = (at: number, size: number, of: number) =>
      at < PADDING ? PADDING - at : at + size > of - PADDING ? of - PADDING - at - size : 0;
    const by = {
      x: into(x + box.x * scale, box.width * scale, width),
      y: into(y + box.y * scale, box.height * scale, height),
    };
    if (!by.x && !by.y) return;
    this.#isMoved = true;
    this.#sight = { scale, x: x + by.x, y: y + by.y };
    this.#show();
  }

  #onKey(event: KeyboardEvent): void {
    if (!isPlain(event)) return;
    if (event.target === this.#filter) {
      if (event.key !== "Escape") return;
      if (this.#filter.value) setTraits(this.#model, { filter: "" });
      else this.#card.picture.focus({ preventScroll: true });
      event.preventDefault();
      return;
    }
    const key = this.#board.keyOf(event.target);
    const [dx, dy] = ARROWS[event.key] ?? [0, 0];
    if ((dx || dy) && this.#placed) {
      const next = beside(this.#placed, key ?? "", dx, dy);
      if (next) this.#board.focus(next);
    } else if (event.key === "Enter" && key !== null) this.#pick(key);
    else if (event.key === "+" || event.key === "=") this.#zoom(STEP);
    else if (event.key === "-") this.#zoom(1 / STEP);
    else if (event.key === "0") this.#showAll();
    else if (event.key === "/") this.#filter.focus();
    else if (event.key === "Escape" && this.#picked !== null) this.#pick(null);
    else return;
    event.preventDefault();
  }

  #point(key: string | null): void {
    if (key === this.#pointed) return;
    this.#pointed = key;
    this.#mark();
  }

  #pick(key: string | null): void {
    this.#picked = key === this.#picked ? null : key;
    if (key !== null) this.#reached = key;
    const item = key === null ? undefined : this.#graph.items.get(key);
    this.#mark();
    const wiring = this.#stream.shown;
    if (!item || !wiring || this.#picked === null) return;
    const { kind, facts, lines } = describe(item, wiring);
    this.#card.say([`${kind} ${item.name}`, ...facts, ...lines]);
  }

  /**
   * Highlights the box under the pointer, or else the picked one, with its wires; and shows its facts below the
   * picture.
   */
  #mark(): void {
    const key = [this.#pointed, this.#picked].find((one) => one !== null && this.#graph.items.has(one)) ?? null;
    this.#board.point(key, key === null ? new Set() : around(this.#graph, key));
    this.#board.mark(this.#picked, this.#reached);
    const wiring = this.#stream.shown;
    const item = key === null ? undefined : this.#graph.items.get(key);
    const said = item && wiring ? describe(item, wiring) : { kind: HINT, facts: [], lines: this.#about(wiring) };
    setText(this.#name, item?.name ?? "");
    setText(this.#facts, [said.kind, ...said.facts].join(" \u00b7 "));
    const [first, ...others] = said.lines;
    for (const [i, line] of this.#lines.entries()) setText(line, (i ? others.join("  \u00b7  ") : first) ?? "");
    const picked = this.#picked === null ? undefined : this.#graph.items.get(this.#picked);
    const act = picked === item ? this.#actOf(picked) : "";
    // Its room is kept, so that nothing moves.
    this.#act.classList.toggle("rw-wires-none", !act);
    set(this.#act, "disabled", !act);
    if (act) {
      setText(this.#act, act);
      setLabel(this.#act, `${act}: ${picked?.name}`);
    }
  }

  /** The facts about all of it. */
  #about(wiring: WiringFrame | null): string[] {
    const { filtered } = this.#graph;
    return [wiring?.note ?? "", filtered ? `the filter leaves out ${filtered}` : ""].filter(Boolean);
  }

  /** The action of the button for the picked item, or "". */
  #actOf(item: Item | undefined): string {
    if (!item) return "";
    if (item.kind === "fold") return "Unfold";
    if (this.#model.get("unfolded").includes(item.group)) return "Fold";
    const hasNone = !item.wire || item.wire.count === 0 || (item.wire.count !== undefined && item.wire.note);
    return hasNone || lacksKernel(this.#model) || !this.#model.get("_can_open") ? "" : "Message";
  }

  #onAct(): void {
    const item = this.#picked === null ? undefined : this.#graph.items.get(this.#picked);
    if (!item) return;
    const unfolded = this.#model.get("unfolded");
    const act = this.#actOf(item);
    if (act === "Unfold") setTraits(this.#model, { unfolded: [...unfolded, item.group] });
    else if (act === "Fold") setTraits(this.#model, { unfolded: unfolded.filter((one) => one !== item.group) });
    else this.#model.send({ open: item.name });
  }
}
