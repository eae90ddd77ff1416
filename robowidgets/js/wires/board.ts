import { make, makeSvg, set, setBox, setText } from "../shared/dom.ts";
import type { Graph, Item } from "./graph.ts";
import type { Placed } from "./layout.ts";
import { isSilent, rateOf, runsOf, sayingOf } from "./words.ts";

const HEAD = 4;

/** The boxes and the wires between them, with their changing texts. */
export class Board {
  readonly root = make("div", "rw-wires-board rw-pale");
  readonly #elements = new Map<string, HTMLElement>();
  readonly #lines: { from: string; to: string; element: SVGElement }[] = [];

  /** Draws other places. */
  draw(placed: Placed, { items }: Graph): void {
    this.root.style.width = `${placed.width}px`;
    this.root.style.height = `${placed.height}px`;
    this.#elements.clear();
    this.#lines.length = 0;
    const svg = makeSvg("svg");
    svg.ariaHidden = "true";
    for (const { from, to, points } of placed.links) {
      const element = makeSvg("g");
      element.append(makeSvg("path", { d: `M${points.map((point) => point.join(" ")).join(" L")}`, fill: "none" }));
      if (!to.startsWith("topic")) element.append(makeSvg("path", { d: headOf(points), stroke: "none" }));
      svg.append(element);
      this.#lines.push({ from, to, element });
    }
    for (const [key, box] of placed.boxes) {
      const item = items.get(key);
      if (item) this.#elements.set(key, setBox(this.#box(item), box));
    }
    this.root.replaceChildren(svg, ...this.#elements.values());
  }

  /** Updates the words in the boxes. */
  update({ items }: Graph): void {
    for (const [key, element] of this.#elements) {
      const item = items.get(key);
      if (!item) continue;
      const { wire, part, name } = item;
      const [, fact, got, gave] = element.children as unknown as HTMLElement[];
      const words = [`${item.kind === "part" ? part?.kind : item.kind} ${name}`];
      if (wire && fact && got) {
        setText(fact, rateOf(wire));
        setText(got, sayingOf(wire));
        set(element.dataset, "state", wire.offered === false ? "missing" : isSilent(wire) ? "silent" : "");
        words.push(rateOf(wire), sayingOf(wire));
      }
      if (part && fact && got && gave) {
        setText(fact, runsOf(part));
        setText(got, part.kind === "speeds" ? (part.gave ?? "") : part.got ? `got ${part.got}` : "");
        const says = part.kind === "speeds" ? part.got && `asked for by ${part.got}` : part.gave && `gave ${part.gave}`;
        setText(gave, part.problem || says || "");
        set(element.dataset, "state", part.problem ? "problem" : "");
        words.push(`ran ${runsOf(part)}`, part.problem ?? "", part.got ?? "", part.gave ?? "");
      }
      set(element, "ariaLabel", words.filter(Boolean).join(", "));
    }
  }

  /** Highlights one box with the wires and the boxes around it, and pales the others; null for none. */
  point(key: string | null, near: Set<string>): void {
    this.root.classList.toggle("rw-wires-pointed", key !== null);
    for (const [other, element] of this.#elements)
      set(element.dataset, "near", String(key !== null && near.has(other)));
    for (const { from, to, element } of this.#lines) set(element.dataset, "near", String(from === key || to === key));
  }

  /** Marks the box that the user picked, and the one that Tab reaches. */
  mark(picked: string | null, reached: string | null): void {
    const first = reached !== null && this.#elements.has(reached) ? reached : this.#elements.keys().next().value;
    for (const [key, element] of this.#elements) {
      set(element, "ariaPressed", String(key === picked));
      element.tabIndex = key === first ? 0 : -1;
    }
  }

  focus(key: string): void {
    this.#elements.get(key)?.focus({ preventScroll: true });
  }

  /** The key of the box that an event is on. */
  keyOf(target: EventTarget | null): string | null {
    const box = target instanceof Element ? target.closest<HTMLElement>(".rw-wire-box") : null;
    return box?.dataset.key ?? null;
  }

  #box({ key, kind, name, part, wire, members }: Item): HTMLElement {
    const element = make("div", `rw-wire-box rw-wire-${kind}`);
    element.role = "button";
    element.dataset.key = key;
    if (part) element.dataset.part = part.kind;
    const label = make("span", "rw-wire-name", members ? `${name}/\u2026` : name);
    label.title = name;
    element.append(label);
    if (wire || part || members) element.append(make("span", "rw-wire-fact", members ? String(members.length) : ""));
    if (wire || (part && part.kind !== "widget")) element.append(make("span", "rw-wire-line"));
    if (part && part.kind !== "widget") element.append(make("span", "rw-wire-line"));
    return element;
  }
}

/** The head of an arrow that comes from the left, or, if it leads back, from the right. */
function headOf(points: [x: number, y: number][]): string {
  const [[x, y], [before]] = [points.at(-1) ?? [0, 0], points.at(-2) ?? [0, 0]];
  const back = x >= before ? -1 : 1;
  return `M${x} ${y} l${back * HEAD * 1.6} ${-HEAD} v${2 * HEAD} Z`;
}
