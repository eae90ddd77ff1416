import type { Box, Point } from "../shared/box.ts";
import { copyText } from "../shared/copy.ts";
import {
  boxWithin,
  isDragged,
  make,
  makeButton,
  makeIcon,
  pointIn,
  set,
  setBox,
  setHidden,
  setText,
} from "../shared/dom.ts";
import { isPlain, on } from "../shared/events.ts";
import { keepKeys } from "../shared/keys.ts";
import { setTraits } from "../shared/model.ts";
import { followTheme } from "../shared/theme.ts";
import { Changes, isField, isUndo, keepChange } from "../shared/undo.ts";
import type { Cards } from "./traits.ts";
import {
  edgeAt,
  edgeBox,
  fromBoxes,
  grown,
  inserted,
  isSame,
  moved,
  type Part,
  PRESETS,
  type Preset,
  pack,
  placeWords,
  presetOf,
  resized,
  type Side,
  stepped,
  toCode,
  type Zone,
  zoneAt,
} from "./tree.ts";
import type { Item, ScreenView } from "./view.ts";

const SIDES: Record<string, Side> = { ArrowLeft: "left", ArrowRight: "right", ArrowUp: "above", ArrowDown: "below" };
const INTERACTIVE = "button, input, select, textarea, a, [tabindex], .rw-over";
const COLORS = ["ground", "ink", "on-ink", "line", "pointer", "on-pointer", "muted", "button", "guide"];
const ICONS: Record<Preset | "copy", string> = {
  laser: "M6 11.5L.8 3.6A8 8 0 0 1 11.2 3.6z",
  camera: "M.5 3h2.7l1-1.6h3.6l1 1.6h2.7v8H.5z M6 4.6a2.2 2.2 0 1 0 0 4.4a2.2 2.2 0 1 0 0-4.4z",
  plots: "M0 .5h1.4v9.7H12v1.4H0z M2.4 7.4l3-4 2.1 1.9L10.7 1l1.1.9-4.1 5.5-2.1-1.9-2.1 2.8z",
  copy: "M4 .5h7.5V9H9.6V7.7h.6V1.8H5.3v.7H4z M.5 3.5H8v8H.5z",
};
const PRESET_WORDS: Record<Preset, string> = { laser: "Large laser", camera: "Large camera", plots: "Large plots" };
const GRIP = "Move with the arrows, resize with Shift and arrows; Enter keeps it, Escape undoes it; F for full screen";
/** Milliseconds for which a finger rests on a header before it drags the card. */
const LONG_PRESS_MS = 450;
const WORDS_MS = 4000;
const GLIDE_MS = 120;
/** The name of the place that a dragged card would take; no card has it. */
const PLACE = "\0";

type Boxes = Map<string, Box>;
type PlacedEdge = NonNullable<ReturnType<typeof edgeBox>>;

/** Lets the user arrange the cards of a screen by pointer and keys, undo that, and show one of them in full screen. */
export class Arranger {
  /** The rectangle at the place that a dragged card would take. */
  readonly place = make("div", "rw-drop-place");
  readonly #view: ScreenView;
  readonly #signal: AbortSignal;
  readonly #line = make("div", "rw-edge-line");
  readonly #outline = make("div", "rw-drag-outline");
  readonly #words = make("div", "rw-arranged-words");
  readonly #live = make("div", "rw-arranged-live");
  readonly #tools = make("span", "rw-arrange-tools");
  readonly #presets = new Map<Preset, HTMLButtonElement>();
  readonly #copy: HTMLButtonElement;
  readonly #changes: Changes;
  readonly #glides: Animation[] = [];
  #strip: HTMLElement | null = null;
  /** The arrangement during a drag, and after arrows until Enter. */
  #preview: Part | null = null;
  /** The card that arrows have moved. */
  #stepped = "";
  /** The card in full screen. */
  #full = "";
  #isLayingOut = false;
  #drag: AbortController | null = null;
  #wordsEnd: ReturnType<typeof setTimeout> | undefined;

  constructor(view: ScreenView, signal: AbortSignal) {
    this.#view = view;
    this.#signal = signal;
    for (const element of [this.#line, this.#outline, this.#words]) element.hidden = true;
    this.#live.ariaLive = "polite";
    for (const preset of PRESETS) {
      const onClick = () => this.#toPreset(preset);
      const button = makeButton("rw-arrange-tool", PRESET_WORDS[preset], onClick, signal);
      button.append(makeIcon(ICONS[preset]));
      this.#presets.set(preset, button);
    }
    this.#copy = makeButton("rw-arrange-tool", "Copy arrangement", () => this.#copyCode(), signal);
    this.#copy.append(makeIcon(ICONS.copy));
    this.#tools.append(...this.#presets.values(), this.#copy);
    const { root } = view;
    this.#changes = new Changes(root, signal);
    root.tabIndex = -1;
    on(root, "pointerover", ({ target }) => this.#addGrip(this.#itemOf(target)), signal);
    on(root, "focusin", () => [...view.items.values()].forEach((item) => void this.#addGrip(item)), signal);
    on(root, "pointerdown", (event) => this.#onDown(event), signal);
    on(root, "pointermove", (event) => this.#onMove(event), signal);
    on(root, "pointerleave", () => !this.#drag && this.#showEdge(null), signal);
    on(root, "dblclick", (event) => this.#onDoubleClick(event), signal);
    on(root, "keydown", (event) => this.#onKey(event), signal);
    on(
      document,
      "fullscreenchange" as "visibilitychange",
      () => !document.fullscreenElement && this.#leaveFull(),
      signal,
    );
  }

  /** The arrangement to show; null if the places of the widgets decide. */
  get shown(): Part | null {
    if (this.#full && this.#view.items.has(this.#full)) return { card: this.#full };
    return this.#preview ?? this.#view.tree;
  }

  /** Classes of the screen. */
  get classes(): string[] {
    return this.#full ? ["full"] : [];
  }

  /** Elements after the cards. */
  get elements(): (HTMLElement | null)[] {
    return [this.#full ? this.#strip : null, this.#line, this.#outline, this.#words, this.#live];
  }

  /** Updates the buttons in the bar, after cards have come or gone, or the bar has been rendered. */
  update(): void {
    const { root, items, tree } = this.#view;
    if (this.#full && !items.has(this.#full)) this.#leaveFull();
    const cards = [...items.values()];
    for (const [preset, button] of this.#presets) {
      const wanted = presetOf(preset, cards);
      setHidden(button, !wanted);
      set(button, "ariaPressed", String(wanted !== null && isSame(tree, wanted)));
    }
    setHidden(this.#copy, !tree);
    const note = root.querySelector(":scope > .rw-item > .rw-player > .rw-play-note");
    const row = root.querySelector(":scope > .rw-item > .rw-stop-bar > .rw-stop-row");
    if (note && note.previousSibling !== this.#tools) note.before(this.#tools);
    if (row && row.lastChild !== this.#tools) row.append(this.#tools);
    this.#updateStrip();
  }

  // Cards and their boxes

  #itemOf(target: EventTarget | null): Item | null {
    const element = target instanceof Element ? target : null;
    return [...this.#view.items.values()].find((item) => item.element.contains(element)) ?? null;
  }

  #cardOf({ element }: Item): HTMLElement | null {
    return element.querySelector(":scope > .rw-card");
  }

  /** The card whose header, and no control in it, is the target of an event. */
  #headerItemOf({ target }: Event): Item | null {
    const item = this.#itemOf(target);
    const header = target instanceof Element ? target.closest(".rw-header") : null;
    if (!item || !header || header.parentElement !== this.#cardOf(item)) return null;
    const control = (target as Element).closest(INTERACTIVE);
    const isFree = !control || !header.contains(control) || control.matches(".rw-grip");
    return isFree ? item : null;
  }

  #labelOf(item: Item): string {
    return this.#cardOf(item)?.ariaLabel || item.name;
  }

  #addGrip(item: Item | null): void {
    const header = item && this.#cardOf(item)?.querySelector<HTMLElement>(":scope > .rw-header");
    if (!item || !header || header.querySelector(":scope > .rw-grip") || this.#view.items.size < 2) return;
    const grip = makeButton("rw-grip", `${this.#labelOf(item)}: ${GRIP}`, () => {}, this.#signal);
    on(grip, "keydown", (event) => this.#onGripKey(event, grip), this.#signal);
    on(grip, "focusout", () => !this.#isLayingOut && this.#keepStepped(), this.#signal);
    header.classList.add("rw-has-grip");
    header.prepend(grip);
  }

  #boxes(): Boxes {
    for (const glide of this.#glides.splice(0)) glide.finish();
    const { root, items } = this.#view;
    const boxes: Boxes = new Map();
    for (const { name, element } of items.values()) {
      const box = boxWithin(root, element);
      if (element.isConnected && box.width && box.height) boxes.set(name, box);
    }
    return boxes;
  }

  /** The arrangement on the screen, also if it was not made by hand. */
  #now(boxes: Boxes): Part | null {
    return this.#preview ?? this.#view.tree ?? fromBoxes(boxes, this.#view.kindOf);
  }

  // Changes

  /** Lays out the screen after a change; the cards glide to their new places. */
  #layOut(change: () => void): void {
    const before = this.#boxes();
    this.#isLayingOut = true;
    change();
    this.#isLayingOut = false;
    if (matchMedia("(prefers-reduced-motion: reduce)").matches) return;
    const after = this.#boxes();
    for (const [name, { x, y }] of after) {
      const from = before.get(name);
      if (!from || Math.hypot(from.x - x, from.y - y) < 2) continue;
      const start = { transform: `translate(${from.x - x}px, ${from.y - y}px)` };
      const element = this.#view.items.get(name)?.element;
      if (!element) continue;
      this.#glides.push(element.animate([start, { transform: "none" }], { duration: GLIDE_MS, easing: "ease-out" }));
    }
  }

  #show(preview: Part | null): void {
    if (isSame(preview, this.#preview)) return;
    this.#layOut(() => {
      this.#preview = preview;
      this.#view.layOut();
    });
  }

  /** Keeps an arrangement, or with null the places of the widgets. */
  #keep(tree: Part | null, words: string): void {
    const { model, root } = this.#view;
    const before = model.get("_cards");
    keepChange(root, { words, undo: () => this.#set(before) });
    this.#set(tree ? { all: pack(tree) } : {});
  }

  #set(cards: Cards): void {
    this.#layOut(() => {
      this.#preview = null;
      setTraits(this.#view.model, { _cards: cards });
      this.#view.layOut();
    });
  }

  #toPreset(preset: Preset): void {
    const wanted = presetOf(preset, [...this.#view.items.values()]);
    const isOn = isSame(this.#view.tree, wanted);
    this.#leaveFull();
    // Pressed again, it gives the screen back to the places of its widgets.
    this.#keep(isOn ? null : wanted, PRESET_WORDS[preset].toLowerCase());
  }

  async #copyCode(): Promise<void> {
    const { tree, model } = this.#view;
    if (!tree) return;
    const code = toCode(tree, model.get("_entries"));
    this.#say((await copyText(code)) ? "arrangement copied" : "the browser does not allow to copy");
  }

  /** Shows words at the right of the bar for a while, and announces them. */
  #say(words: string): void {
    const { root } = this.#view;
    const bar = root.querySelector(":scope > .rw-item > :is(.rw-player, .rw-stop-bar)");
    this.#dress();
    setText(this.#live, words);
    setText(this.#words, words);
    setHidden(this.#words, false);
    const box = bar && boxWithin(root, bar as HTMLElement);
    this.#words.style.top = `${box ? box.y + box.height - this.#words.offsetHeight - 3 : 4}px`;
    this.#words.style.right = `${box ? root.offsetWidth - box.x - box.width + 8 : 8}px`;
    clearTimeout(this.#wordsEnd);
    this.#wordsEnd = setTimeout(() => setHidden(this.#words, true), WORDS_MS);
  }

  /** Takes over the colours of the cards. */
  #dress(): void {
    const { root } = this.#view;
    const card = root.querySelector(".rw-card");
    if (!card) return;
    const style = getComputedStyle(card);
    for (const name of COLORS) root.style.setProperty(`--rw-${name}`, style.getPropertyValue(`--rw-${name}`));
  }

  // Pointers

  #onDown(event: PointerEvent): void {
    if (event.button !== 0 || this.#drag || this.#full) return;
    this.#keepStepped();
    const edge = this.#edgeUnder(event);
    if (edge) this.#dragEdge(event, edge);
    const item = edge || this.#view.items.size < 2 ? null : this.#headerItemOf(event);
    if (item) this.#dragCard(event, item);
  }

  #onMove(event: PointerEvent): void {
    if (this.#drag || event.pointerType === "touch" || event.buttons) return;
    this.#showEdge(this.#edgeUnder(event));
  }

  /** The edge at a pointer in the gap between two cards, with its place on the screen. */
  #edgeUnder(event: PointerEvent): PlacedEdge | null {
    const target = event.target instanceof Element ? event.target : null;
    if (this.#full || !target || target.closest(".rw-item")) return null;
    const boxes = this.#boxes();
    const tree = this.#now(boxes);
    const edge = tree && edgeAt(tree, boxes, pointIn(this.#view.root, event));
    return tree && edge && edgeBox(tree, edge, boxes);
  }

  #showEdge(edge: PlacedEdge | null): void {
    const { root } = this.#view;
    setHidden(this.#line, !edge);
    if (!edge) {
      delete root.dataset.rwPoints;
      return;
    }
    root.dataset.rwPoints = edge.way;
    this.#dress();
    setBox(this.#line, edge.line);
  }

  /** Follows a pointer until it is released; Escape cancels. */
  #follow(event: PointerEvent, onMove: (at: Point) => void, onEnd: (isKept: boolean) => void): AbortController {
    const { root } = this.#view;
    const drag = new AbortController();
    this.#drag = drag;
    const signal = AbortSignal.any([drag.signal, this.#signal]);
    const end = (isKept: boolean) => {
      this.#drag = null;
      drag.abort();
      delete root.dataset.rwDrags;
      onEnd(isKept);
    };
    const isIts = ({ pointerId }: PointerEvent) => pointerId === event.pointerId;
    on(window, "pointermove", (move) => isIts(move) && onMove(pointIn(root, move)), signal);
    on(window, "pointerup", (up) => isIts(up) && end(true), signal);
    on(window, "pointercancel", (cancel) => isIts(cancel) && end(false), signal);
    on(window, "keydown", ({ key }) => key === "Escape" && end(false), signal, { capture: true });
    return drag;
  }

  #dragEdge(event: PointerEvent, edge: PlacedEdge): void {
    const { root, kindOf } = this.#view;
    const { tree, sizes } = edge;
    event.preventDefault();
    root.focus({ preventScroll: true });
    root.dataset.rwDrags = edge.way;
    const from = pointIn(root, event);
    const onMove = ({ x, y }: Point) => {
      const by = edge.way === "row" ? x - from.x : y - from.y;
      const preview = resized(tree, edge, by, sizes, kindOf);
      this.#preview = preview;
      this.#view.layOut();
      this.#showEdge(edgeBox(preview, edge, this.#boxes()));
    };
    const onEnd = (isKept: boolean) => {
      const preview = this.#preview;
      this.#showEdge(null);
      if (isKept && preview && !isSame(preview, tree)) this.#keep(preview, "edge moved");
      else this.#show(null);
    };
    this.#follow(event, onMove, onEnd);
  }

  #dragCard(event: PointerEvent, item: Item): void {
    const { root } = this.#view;
    const from = pointIn(root, event);
    const isTouch = event.pointerType === "touch";
    let [boxes, tree, zone]: [Boxes, Part | null, Zone | null] = [new Map(), null, null];
    let box: Box | undefined;
    const begin = () => {
      boxes = this.#boxes();
      tree = this.#now(boxes);
      box = boxes.get(item.name);
      this.#dress();
      getSelection()?.removeAllRanges();
      root.dataset.rwDrags = "card";
      item.element.classList.add("rw-dragged");
      setHidden(this.#outline, false);
    };
    const onMove = (at: Point) => {
      if (!box && isDragged(from, at)) {
        // A finger that moves before a long press scrolls the page.
        if (isTouch) return cancel();
        begin();
      }
      if (!box || !tree) return;
      setBox(this.#outline, { ...box, x: box.x + at.x - from.x, y: box.y + at.y - from.y });
      const under = zoneAt(boxes, item.name, at);
      zone = under && isSame(moved(tree, item.name, under), tree) ? null : under;
      this.#show(zone && inserted(tree, { card: PLACE }, zone));
    };
    const end = (isKept: boolean) => {
      clearTimeout(press);
      setHidden(this.#outline, true);
      item.element.classList.remove("rw-dragged");
      if (isKept && tree && zone) this.#keep(moved(tree, item.name, zone), `${this.#labelOf(item)} moved`);
      else this.#show(null);
      if (box) this.#gripOf(item)?.focus({ preventScroll: true });
    };
    const drag = this.#follow(event, onMove, end);
    const cancel = () => {
      drag.abort();
      this.#drag = null;
      end(false);
    };
    const press = isTouch
      ? setTimeout(() => {
          this.#addGrip(item);
          begin();
          if (box) setBox(this.#outline, box);
          const still = (move: Event) => move.preventDefault();
          window.addEventListener("touchmove", still, { passive: false, signal: drag.signal });
        }, LONG_PRESS_MS)
      : undefined;
  }

  #gripOf(item: Item): HTMLElement | null {
    return item.element.querySelector(":scope > .rw-card > .rw-header > .rw-grip");
  }

  #onDoubleClick(event: MouseEvent): void {
    const item = this.#headerItemOf(event);
    if (!item) return;
    getSelection()?.removeAllRanges();
    if (this.#full) this.#leaveFull();
    else this.#toFull(item.name);
  }

  // Keys

  #onKey(event: KeyboardEvent): void {
    const { target, key } = event;
    const isHandled = event.defaultPrevented || isField(target);
    if (key === "Escape" && this.#full) {
      this.#leaveFull();
    } else if (isUndo(event) && !isHandled && !this.#drag) {
      if (this.#stepped) this.#dropStepped();
      else {
        const words = this.#changes.undo();
        if (!words) return;
        this.#say(words);
      }
    } else if ((key === "f" || key === "F") && isPlain(event) && !isHandled) {
      const item = this.#itemOf(target);
      if (this.#full) this.#leaveFull();
      else if (item) this.#toFull(item.name);
      else return;
    } else {
      return;
    }
    event.preventDefault();
    // A screen within another one.
    event.stopPropagation();
  }

  #onGripKey(event: KeyboardEvent, grip: HTMLElement): void {
    const item = this.#itemOf(grip);
    const side = SIDES[event.key];
    if (!item || !isPlain(event)) return;
    if (side && this.#full) {
      this.#toNext(side === "left" || side === "above" ? -1 : 1);
    } else if (side) {
      const boxes = this.#boxes();
      const tree = this.#now(boxes);
      if (!tree) return;
      const { kindOf } = this.#view;
      const next = event.shiftKey ? grown(tree, item.name, side, boxes, kindOf) : stepped(tree, item.name, side);
      this.#stepped = item.name;
      this.#show(next);
      setText(this.#live, `${this.#labelOf(item)}, ${placeWords(next, item.name)}`);
    } else if (event.key === "Enter" && this.#stepped) {
      this.#keepStepped();
    } else if (event.key === "Escape" && this.#stepped) {
      this.#dropStepped();
    } else {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
  }

  #keepStepped(): void {
    const item = this.#view.items.get(this.#stepped);
    const preview = this.#preview;
    this.#stepped = "";
    if (item && preview) this.#keep(preview, `${this.#labelOf(item)} moved`);
  }

  #dropStepped(): void {
    this.#stepped = "";
    this.#show(null);
    setText(this.#live, "as before");
  }

  // Full screen

  #toFull(name: string): void {
    const { root, items, model } = this.#view;
    this.#keepStepped();
    const focused = (root.getRootNode() as Document | ShadowRoot).activeElement;
    const keepsFocus = focused?.closest(".rw-picture") && items.get(name)?.element.contains(focused);
    this.#showEdge(null);
    this.#dress();
    this.#full = name;
    this.#strip ??= this.#makeStrip();
    this.#view.layOut();
    if (!keepsFocus) this.#focusStrip();
    // In the browser's full screen Escape would not reach Stop.
    if (model.get("_kind").includes("feed") || document.fullscreenElement) return;
    root.requestFullscreen?.().catch(() => {
      // The host does not allow it: the card fills the place of the screen.
    });
  }

  #leaveFull(): void {
    const item = this.#view.items.get(this.#full);
    if (!this.#full) return;
    this.#full = "";
    this.#view.layOut();
    if (item) this.#gripOf(item)?.focus({ preventScroll: true });
    const page = this.#view.root.getRootNode() as Document | ShadowRoot;
    // Rejected if the user has left it meanwhile.
    if (page.fullscreenElement === this.#view.root) document.exitFullscreen().catch(() => {});
  }

  #makeStrip(): HTMLElement {
    const strip = make("div", "rw-card-strip");
    strip.role = "toolbar";
    strip.ariaLabel = "cards in full screen";
    followTheme(strip, this.#view.model, this.#signal, () => this.#dress());
    keepKeys(strip, this.#signal);
    const onKey = (event: KeyboardEvent) => {
      const side = SIDES[event.key];
      if (!side || !isPlain(event)) return;
      event.preventDefault();
      event.stopPropagation();
      this.#toNext(side === "left" || side === "above" ? -1 : 1);
    };
    on(strip, "keydown", onKey, this.#signal);
    return strip;
  }

  #updateStrip(): void {
    const strip = this.#strip;
    if (!strip || !this.#full) return;
    const buttons = [...this.#view.items.values()].map((item) => {
      const label = this.#labelOf(item);
      const button = makeButton("rw-card-strip-card", label, () => this.#toCard(item.name), this.#signal, label);
      set(button, "ariaPressed", String(item.name === this.#full));
      button.tabIndex = item.name === this.#full ? 0 : -1;
      return button;
    });
    const hadFocus = strip.matches(":focus-within");
    const back = makeButton("rw-card-strip-back", "Back (Escape)", () => this.#leaveFull(), this.#signal, "\u00d7");
    strip.replaceChildren(...buttons, back);
    if (hadFocus) this.#focusStrip();
  }

  #focusStrip(): void {
    this.#strip?.querySelector<HTMLElement>("[aria-pressed=true]")?.focus({ preventScroll: true });
  }

  #toCard(name: string): void {
    this.#full = name;
    this.#view.layOut();
    this.#focusStrip();
  }

  #toNext(by: 1 | -1): void {
    const names = [...this.#view.items.keys()];
    const i = names.indexOf(this.#full);
    const next = names[(i + by + names.length) % names.length];
    if (next !== undefined) this.#toCard(next);
  }
}
