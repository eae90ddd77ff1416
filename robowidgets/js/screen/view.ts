import { make, setText } from "../shared/dom.ts";
import { onAbort } from "../shared/events.ts";
import { type Host, type Model, onChange } from "../shared/model.ts";
import { enterBoxes } from "../shared/room.ts";
import { followTheme } from "../shared/theme.ts";
import { Arranger } from "./arranger.ts";
import type { Place, Room, ScreenTraits } from "./traits.ts";
import { fills, leastSize, type Part, partsOf, present, read, sharesOf, takesRest } from "./tree.ts";

const COLUMNS: Place[] = ["wide", "narrow", "map"];
/** Places whose widgets keep them in an arrangement by hand. */
const FIXED: Place[] = ["bar", "topics"];
const OLD_HOST = "This page cannot show several widgets on one screen: it needs anywidget 0.11 or later.";

/** The element of a widget on the screen. */
interface Held {
  element: HTMLElement;
  ended: AbortController;
}

/** A card that can be arranged. */
export interface Item {
  name: string;
  kind: string;
  element: HTMLElement;
}

/** Lays out widgets, each of which is rendered once: a change of its place moves its element. */
export class ScreenView {
  readonly root: HTMLElement = make("div", "rw-one-screen");
  readonly model: Model<ScreenTraits>;
  /** The cards that can be arranged, in the order of the page, by their names. */
  readonly items = new Map<string, Item>();
  readonly #host: Host | undefined;
  readonly #notes = make("div", "rw-notes");
  readonly #boxes = new Map<string, HTMLElement>();
  readonly #held = new Map<string, Held>();
  readonly #arranger: Arranger;

  /** @param host of anywidget 0.11; undefined in older ones */
  constructor(model: Model<ScreenTraits>, element: HTMLElement, host: Host | undefined, signal: AbortSignal) {
    this.model = model;
    this.#host = host;
    this.#notes.role = "status";
    element.classList.add("rw-screen-cell");
    element.append(this.root);
    // Before its widgets, which take its look.
    followTheme(this.root, model, signal);
    onAbort(signal, () => {
      for (const { ended } of this.#held.values()) ended.abort();
      this.root.remove();
    });
    onChange(model, ["_notes"], () => this.#note(), signal);
    onChange(model, ["_children", "_kind", "_cards"], () => this.layOut(), signal);
    this.#arranger = new Arranger(this, signal);
    this.#note();
    this.layOut();
  }

  /** The arrangement by hand of the cards that exist; null if their places decide. */
  get tree(): Part | null {
    const { all } = this.model.get("_cards");
    return all === undefined ? null : present(read(all), [...this.items.values()]);
  }

  readonly kindOf = (name: string): string => this.items.get(name)?.kind ?? "";

  #note(): void {
    const lines = this.#host ? this.model.get("_notes") : [OLD_HOST];
    setText(this.#notes, lines.join("\n"));
  }

  layOut(): void {
    const [rooms, kinds] = [this.model.get("_children"), this.model.get("_kind").split(" ").filter(Boolean)];
    const kept = new Set(rooms.map(({ widget }) => widget));
    for (const [widget, { element, ended }] of this.#held) {
      if (kept.has(widget)) continue;
      this.#held.delete(widget);
      ended.abort();
      element.remove();
    }
    this.items.clear();
    for (const room of rooms) {
      const element = this.#elementOf(room);
      if (FIXED.includes(room.place)) continue;
      this.items.set(room.card, { name: room.card, kind: room.kind, element });
    }
    const at = (place: Place) => rooms.filter((room) => room.place === place).map((room) => this.#elementOf(room));
    const tree = this.#arranger.shown;
    const [bar, topics] = [at("bar"), at("topics")];
    const hasOneWide = at("mains").length > 0 && at("smalls").length > 0 && at("wides").length === 1;
    this.root.className = [
      "one-screen",
      ...kinds,
      ...(topics.length ? ["has-topics"] : []),
      ...(tree ? ["by-hand"] : hasOneWide ? ["one-wide"] : []),
      ...this.#arranger.classes,
    ]
      .map((name) => `rw-${name}`)
      .join(" ");
    const top = kinds.includes("feed") ? [...bar, this.#notes] : [this.#notes, ...bar];
    const focused = (this.root.getRootNode() as Document | ShadowRoot).activeElement;
    const all = tree ? [this.#box("screen", [this.#boxOf(tree)])] : this.#byPlaces(at);
    place(this.root, [...top, ...topics, ...all, ...this.#arranger.elements]);
    for (const { element } of this.#held.values()) enterBoxes(element);
    // An element that moves in the page loses the focus.
    if (focused instanceof HTMLElement && this.root.contains(focused)) focused.focus({ preventScroll: true });
    this.#arranger.update();
  }

  #byPlaces(at: (place: Place) => HTMLElement[]): Elements {
    for (const { element } of this.items.values()) unsize(element);
    const [mains, smalls] = [this.#box("mains", at("mains")), this.#box("smalls", at("smalls"))];
    const whole = this.#box("whole", mains && smalls ? [mains, smalls] : mains ? [mains] : []);
    const screen = this.#box("screen", [
      whole,
      this.#box("wides", at("wides")),
      !mains && smalls,
      this.#box("below", at("below")),
    ]);
    const columns = this.#box(
      "columns",
      COLUMNS.map((name) => this.#box(`${name}-column`, at(name))),
    );
    return [screen, columns, ...at("foot")];
  }

  /** The element of a part of an arrangement by hand. */
  #boxOf(part: Part, path = "0"): HTMLElement {
    if (part.card !== undefined) return this.items.get(part.card)?.element ?? this.#arranger.place;
    const parts = partsOf(part);
    const elements = parts.map((one, i) => this.#boxOf(one, `${path}-${i}`));
    const box = this.#boxes.get(path) ?? make("div", "");
    this.#boxes.set(path, box);
    box.className = part.row ? "rw-part rw-part-row" : "rw-part rw-part-column";
    place(box, elements);
    const shares = sharesOf(parts);
    const rests = parts.map((one) => takesRest(one, this.kindOf));
    const [least] = leastSize(part, this.kindOf);
    for (const [i, one] of parts.entries()) {
      const row = part.row && { share: shares[i] ?? 0, least };
      const element = elements[i];
      if (element) size(element, one, row, rests[i] || !rests.includes(true), this.kindOf);
    }
    if (path === "0") {
      // Its cards have the style of small ones.
      box.classList.add("rw-whole");
      size(box, {}, undefined, true, this.kindOf);
    }
    return box;
  }

  /** A box with these elements, or null if there are none. */
  #box(name: string, elements: Elements): HTMLElement | null {
    const box = this.#boxes.get(name) ?? make("div", `rw-${name}`);
    this.#boxes.set(name, box);
    place(box, elements);
    return box.firstChild && box;
  }

  /** The element of a widget, which is rendered into it at the first call. */
  #elementOf({ widget, classes, style }: Room): HTMLElement {
    const held = this.#held.get(widget) ?? { element: make("div", ""), ended: new AbortController() };
    const { element, ended } = held;
    if (!this.#held.has(widget)) {
      this.#held.set(widget, held);
      element.classList.add("rw-item", ...classes);
      for (const [name, value] of Object.entries(style)) element.style.setProperty(name, value);
      this.#render(widget, element, ended.signal);
    }
    return element;
  }

  async #render(name: string, element: HTMLElement, signal: AbortSignal): Promise<void> {
    try {
      const widget = await this.#host?.getWidget(name);
      if (!signal.aborted) await widget?.render({ el: element, signal });
      this.#arranger.update();
    } catch (error) {
      if (!signal.aborted) setText(element, `This widget cannot be shown: ${error}`);
    }
  }
}

const SIZES = ["--rw-share", "--rw-row-least", "--rw-height", "--rw-least", "--rw-least-height", "--rw-grow"];

function unsize(element: HTMLElement): void {
  for (const name of SIZES) element.style.removeProperty(name);
  delete element.dataset.rwFills;
  element.classList.remove("rw-high");
}

/** Gives a part its sizes in its column or row. A row has shares. */
function size(
  element: HTMLElement,
  part: Part,
  row: { share: number; least: number } | undefined,
  grows: boolean,
  kindOf: (name: string) => string,
): void {
  unsize(element);
  const [least, leastHeight] = leastSize(part, kindOf);
  const values: [string, string | number | undefined][] = [
    ["--rw-share", row?.share.toFixed(4)],
    ["--rw-row-least", row && `${row.least}px`],
    ["--rw-height", part.height ? `${part.height}px` : "auto"], // it would be inherited
    ["--rw-least", `${least}px`],
    ["--rw-least-height", `${part.card === undefined && !part.height ? 0 : Math.max(part.height ?? 0, leastHeight)}px`],
    ["--rw-grow", part.height || !grows ? 0 : 1],
  ];
  for (const [name, value] of values) if (value !== undefined) element.style.setProperty(name, String(value));
  if (part.height) element.classList.add("rw-high");
  if (part.card !== undefined && (part.height || fills(kindOf(part.card)))) element.dataset.rwFills = "";
}

type Elements = (HTMLElement | null | false)[];

/** Puts elements into a parent in this order, and no others. Elements that are at their places are not touched. */
function place(parent: HTMLElement, elements: Elements): void {
  const wanted = elements.filter((element) => element !== null && element !== false);
  for (const child of [...parent.children]) if (!wanted.includes(child as HTMLElement)) child.remove();
  for (const [i, element] of wanted.entries()) {
    if (parent.children[i] !== element) parent.insertBefore(element, parent.children[i] ?? null);
  }
}
