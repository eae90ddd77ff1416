import { make, setText } from "../shared/dom.ts";
import { onAbort } from "../shared/events.ts";
import { type Host, type Model, onChange } from "../shared/model.ts";
import { enterBoxes } from "../shared/room.ts";
import type { Place, Room, ScreenTraits } from "./traits.ts";

const COLUMNS: Place[] = ["wide", "narrow", "map"];
const OLD_HOST = "This page cannot show several widgets on one screen: it needs anywidget 0.11 or later.";

/** The element of a widget on the screen. */
interface Held {
  element: HTMLElement;
  ended: AbortController;
}

/** Lays out widgets, each of which is rendered once: a change of its place moves its element. */
export class ScreenView {
  readonly #model: Model<ScreenTraits>;
  readonly #host: Host | undefined;
  readonly #root = make("div", "rw-one-screen");
  readonly #notes = make("div", "rw-notes");
  readonly #boxes = new Map<string, HTMLElement>();
  readonly #held = new Map<string, Held>();

  /** @param host of anywidget 0.11; undefined in older ones */
  constructor(model: Model<ScreenTraits>, element: HTMLElement, host: Host | undefined, signal: AbortSignal) {
    this.#model = model;
    this.#host = host;
    this.#notes.role = "status";
    element.classList.add("rw-screen-cell");
    element.append(this.#root);
    onAbort(signal, () => {
      for (const { ended } of this.#held.values()) ended.abort();
      this.#root.remove();
    });
    onChange(model, ["_notes"], () => this.#note(), signal);
    onChange(model, ["_children", "_kind"], () => this.#layOut(), signal);
    this.#note();
    this.#layOut();
  }

  #note(): void {
    const lines = this.#host ? this.#model.get("_notes") : [OLD_HOST];
    setText(this.#notes, lines.join("\n"));
  }

  #layOut(): void {
    const [rooms, kinds] = [this.#model.get("_children"), this.#model.get("_kind").split(" ").filter(Boolean)];
    const kept = new Set(rooms.map(({ widget }) => widget));
    for (const [widget, { element, ended }] of this.#held) {
      if (kept.has(widget)) continue;
      this.#held.delete(widget);
      ended.abort();
      element.remove();
    }
    const at = (place: Place) => rooms.filter((room) => room.place === place).map((room) => this.#elementOf(room));
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
    const [bar, topics] = [at("bar"), at("topics")];
    this.#root.className = ["one-screen", ...kinds, ...(topics.length ? ["has-topics"] : [])]
      .map((name) => `rw-${name}`)
      .join(" ");
    const top = kinds.includes("feed") ? [...bar, this.#notes] : [this.#notes, ...bar];
    place(this.#root, [...top, ...topics, screen, columns, ...at("foot")]);
    for (const { element } of this.#held.values()) enterBoxes(element);
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
    } catch (error) {
      if (!signal.aborted) setText(element, `This widget cannot be shown: ${error}`);
    }
  }
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
