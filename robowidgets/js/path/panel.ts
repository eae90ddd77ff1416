import { make, makeButton, makeSvg, setHidden, setText } from "../shared/dom.ts";
import { on } from "../shared/events.ts";
import type { LayerAbout } from "./layers.ts";

/** A row of the list of layers. */
export interface Row {
  name: string;
  kind: LayerAbout["kind"] | "shape";
  /** For a path, true if it is the robot's. */
  isRobot: boolean;
  fact: string;
  /** True if it has something to draw. */
  isThere: boolean;
  isOn: boolean;
  /** The frame in which it is drawn if that is not the one on show; only in the first row of that frame. */
  other?: string;
}

const NOUNS: Record<Row["kind"], string> = {
  pose: "way",
  goal: "goal",
  poses: "poses",
  path: "plan",
  scan: "newest scan",
  cone: "sonar",
  grid: "grid",
  shape: "program",
};

/** The list of layers, from top to bottom, each with a square that takes it off and puts it on. */
export class Panel {
  readonly root = make("div", "rw-layers rw-over");
  readonly #list = make("div", "rw-layers-list");
  readonly #foot = make("div", "rw-layers-foot");
  readonly #onToggle: (name: string) => void;
  readonly #onFrame: (frame: string) => void;
  readonly #signal: AbortSignal;
  #built = "";
  #facts: HTMLElement[] = [];

  constructor(onToggle: (name: string) => void, onFrame: (frame: string) => void, signal: AbortSignal) {
    this.#onToggle = onToggle;
    this.#onFrame = onFrame;
    this.#signal = signal;
    const head = make("div", "rw-layers-head");
    head.append(make("b", "", "Layers"), make("span", "", "top to bottom"));
    this.#list.role = "list";
    this.root.role = "group";
    this.root.ariaLabel = "layers";
    this.root.append(head, this.#list, this.#foot);
    setHidden(this.root, true);
    // On the list nothing moves the map, and keys act on its buttons.
    for (const type of ["pointerdown", "click", "wheel", "keydown", "pointermove"] as const)
      on(this.root, type as "click", (event) => event.stopPropagation(), signal, { passive: true });
  }

  /** @param foot the frame, and a note on its transforms */
  update(rows: Row[], foot: string[]): void {
    const key = JSON.stringify(rows.map(({ fact: _fact, ...rest }) => rest));
    if (key !== this.#built) {
      this.#built = key;
      this.#facts = [];
      const focused = this.root.contains(document.activeElement) ? document.activeElement?.ariaLabel : null;
      this.#list.replaceChildren(...rows.map((row) => this.#make(row)));
      for (const one of focused ? this.#list.querySelectorAll("button") : [])
        if (one.ariaLabel === focused) one.focus();
    }
    for (const [i, { fact }] of rows.entries()) setText(this.#facts[i] as HTMLElement, fact);
    const [frame = "", more = ""] = foot;
    if (this.#foot.childElementCount === 0) this.#foot.append(make("b", ""), make("span", ""));
    const [bold, plain] = [...this.#foot.children] as [HTMLElement, HTMLElement];
    setText(bold, frame);
    setText(plain, more);
  }

  #make({ name, kind, isRobot, isThere, isOn, other }: Row): HTMLElement {
    const row = make("div", "rw-layers-row");
    row.role = "listitem";
    row.classList.toggle("rw-missing", !isThere);
    row.classList.toggle("rw-off", !isOn);
    const square = make("button", "rw-layers-square");
    square.type = "button";
    square.role = "checkbox";
    square.ariaChecked = String(isOn);
    square.ariaLabel = name;
    square.title = isOn ? "Take it off the map" : "Draw it on the map";
    // A program removes its own drawings.
    square.disabled = kind === "shape";
    on(square, "click", () => this.#onToggle(name), this.#signal);
    const title = make("span", "rw-layers-name", name);
    title.title = name;
    const fact = make("span", "rw-layers-fact");
    this.#facts.push(fact);
    row.append(square, sampleOf(kind, isRobot, isThere), title, make("span", "rw-layers-kind", NOUNS[kind]), fact);
    if (other) {
      const show = () => this.#onFrame(other);
      const button = makeButton("rw-layers-frame", "Show the map in this frame", show, this.#signal, `Frame ${other}`);
      button.ariaLabel = null;
      row.append(button);
    }
    return row;
  }
}

/** The symbol of a layer on the map. */
function sampleOf(kind: Row["kind"], isRobot: boolean, isThere: boolean): SVGElement {
  const svg = makeSvg("svg", { viewBox: "0 0 26 12", width: 26, height: 12, "aria-hidden": "true" });
  const add = (tag: string, attributes: Record<string, string | number>) => svg.append(makeSvg(tag, attributes));
  const stroke = (color: string, width: number, more = {}) => ({
    stroke: `var(--rw-${color})`,
    "stroke-width": width,
    fill: "none",
    ...more,
  });
  if (!isThere)
    add("rect", { x: 1, y: 1, width: 24, height: 10, ...stroke("guide", 1, { "stroke-dasharray": "3 2" }) });
  else if (kind === "scan") {
    for (const [i, y] of [5, 6.5, 8, 7.5, 6, 5].entries())
      add("rect", { x: 1 + 4.4 * i, y, width: 2.6, height: 2.6, fill: "var(--rw-reading)" });
  } else if (kind === "cone") {
    add("path", { d: "M23 2L2 6L23 10", ...stroke("guide", 1.25) });
    add("path", { d: "M23 2Q25 6 23 10", ...stroke("reading", 2.5) });
  } else if (kind === "grid") {
    add("rect", { x: 1, y: 1, width: 8, height: 10, fill: "var(--rw-muted)" });
    add("rect", { x: 9, y: 1, width: 8, height: 10, fill: "var(--rw-area)" });
    add("rect", { x: 17, y: 1, width: 8, height: 10, fill: "var(--rw-seen)" });
    add("rect", { x: 1, y: 1, width: 24, height: 10, ...stroke("line", 1) });
  } else if (kind === "goal") {
    add("circle", { cx: 13, cy: 6, r: 5, ...stroke("pointer", 1.75) });
    add("circle", { cx: 13, cy: 6, r: 1.75, fill: "var(--rw-pointer)" });
  } else if (kind === "path") add("path", { d: "M0 6H26", ...stroke("ink", 1.75, { "stroke-dasharray": "6 4" }) });
  else if (kind === "poses") {
    for (const [x, y] of [
      [3, 3],
      [10, 8],
      [17, 4],
      [22, 9],
    ] as const)
      add("path", { d: `M${x} ${y}l4 -2`, ...stroke("muted", 1.25) });
  } else if (kind === "shape") add("path", { d: "M1 6H25M1 2v8M25 2v8", ...stroke("own", 1.75) });
  else {
    const color = isRobot ? "ink" : "guide";
    add("path", { d: "M0 6H18", ...stroke(color, isRobot ? 1.75 : 1.25) });
    add("circle", { cx: 21, cy: 6, r: 3.5, ...stroke(color, 1.5, { fill: isRobot ? "var(--rw-ink)" : "none" }) });
  }
  return svg;
}
