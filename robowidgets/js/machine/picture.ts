import type { Box } from "../shared/box.ts";
import { make, makeSvg, set, setBox, setHidden, setText } from "../shared/dom.ts";
import { ANY, isTimed, type Placed, type PlacedMove, type PlacedState } from "./layout.ts";
import { activeText, isActive, isTaken, labelOf, type Step, timeLeft, verdictOf } from "./step.ts";
import type { Fired } from "./traits.ts";

const HEAD = 5;

/** The appearance of a machine, apart from its places. */
interface Shown {
  step: Step;
  fired: Fired[];
  /** True if the program drives, or will go on to drive. */
  isInForce: boolean;
  /** True if rings empty by tenths. */
  isCalm: boolean;
  /** Path of the state in which a step failed. */
  failed: string;
  /** True if the user may choose a state. */
  canGo: boolean;
}

/** The states of a machine as boxes, and its moves as arrows with words. */
export class Picture {
  readonly root = make("div", "rw-machine-board rw-pale");
  #updates: ((shown: Shown) => void)[] = [];
  readonly #onGo: (path: string) => void;

  /** @param onGo called with the path of a state that the user chose */
  constructor(onGo: (path: string) => void) {
    this.#onGo = onGo;
  }

  /** Draws other places at a scale. */
  draw(placed: Placed, scale: number): void {
    this.root.style.zoom = String(scale);
    this.root.style.width = `${placed.width}px`;
    this.root.style.height = `${placed.height}px`;
    const svg = makeSvg("svg");
    svg.ariaHidden = "true";
    this.#updates = [];
    const any = placed.any.map((box) => setBox(make("div", "rw-machine-any", "any state"), box));
    const lanes = placed.lanes.map((lane) => setBox(make("div", "rw-machine-lane", lane.name), lane));
    const states = placed.states.map((state) => this.#state(state, svg));
    const labels = placed.moves.map((move) => this.#move(move, svg));
    // Frames lie below the arrows within them.
    const isFrame = (_: HTMLElement, i: number) => placed.states[i]?.isOpen;
    this.root.replaceChildren(
      ...states.filter(isFrame),
      ...lanes,
      svg,
      ...any,
      ...states.filter((state, i) => !isFrame(state, i)),
      ...labels,
    );
  }

  update(shown: Shown): void {
    for (const update of this.#updates) update(shown);
  }

  #state({ machine, state, isInitial, isOpen, ...box }: PlacedState, svg: SVGElement): HTMLElement {
    const element = setBox(make("div", "rw-machine-state"), box);
    const name = make("span", "rw-machine-state-name", state.name);
    name.title = state.name;
    const isFolded = state.machines.length > 0 && !isOpen;
    const within = make("span", "rw-machine-state-within");
    const words = make("span", "rw-machine-state-words");
    words.append(name, within);
    element.append(words);
    element.classList.toggle("rw-machine-state-open", isOpen);
    const [left, ring] = [make("span", "rw-machine-state-left"), make("i", "rw-ring")];
    const isWithRing = isTimed(machine, state);
    if (isWithRing) element.append(left, ring);
    if (isInitial) start(svg, box);
    const go = make("button", "rw-machine-go", "go");
    go.type = "button";
    go.ariaLabel = `Go to the state ${state.name}`;
    go.title = go.ariaLabel;
    go.onclick = () => this.#onGo(state.path);
    element.append(go);
    this.#updates.push(({ step, isInForce, isCalm, failed, canGo }) => {
      set(element.dataset, "failed", String(failed === state.path));
      const isLit = isInForce && isActive(machine, state, step);
      setHidden(go, !canGo || (isLit && !isOpen));
      set(element.dataset, "active", isLit ? (isOpen ? "frame" : "leaf") : "");
      set(element, "ariaCurrent", String(isLit));
      if (isFolded) setText(within, (isLit && activeText(state.machines, step)) || "\u2026");
      if (!isWithRing) return;
      const time = isLit ? timeLeft(machine, state, step) : null;
      setText(left, time ? `${time[0].toFixed(1)} s` : "");
      const share = time && time[1] > 0 ? time[0] / time[1] : 0;
      ring.style.setProperty("--rw-left", String(isCalm ? Math.ceil(10 * share) / 10 : share));
    });
    return element;
  }

  #move({ machine, move, points, label }: PlacedMove, svg: SVGElement): HTMLElement {
    const arrow = add(svg, "g", {});
    add(arrow, "path", { d: `M${points.map((point) => point.join(" ")).join(" L")}`, fill: "none" });
    add(arrow, "path", { d: headOf(points), stroke: "none" });
    const element = setBox(make("div", move.event ? "rw-move" : "rw-move rw-move-plain"), label);
    const name = make("span", "rw-move-name", labelOf(move));
    const numbers = make("span", "rw-move-numbers");
    if (move.event) element.append(make("i", "rw-move-dot"));
    element.append(name, numbers);
    this.#updates.push(({ step, fired, isInForce }) => {
      const source = machine.states.find((state) => state.name === move.source);
      const [value, text] = verdictOf(machine, move, step);
      const isNext = move.after !== null && source !== undefined && isActive(machine, source, step);
      const way = isTaken(machine, move, fired, step) ? "taken" : isNext ? "next" : "";
      set(arrow.dataset, "way", isInForce ? way : "");
      set(element.dataset, "way", arrow.dataset.way);
      const isWatched = source ? isActive(machine, source, step) : move.source === ANY;
      set(element.dataset, "value", isInForce && (isWatched || value === "true") ? value : "");
      setText(numbers, element.dataset.value ? text : "");
      set(element, "title", [labelOf(move), element.dataset.value && `${value} ${text}`].filter(Boolean).join(": "));
    });
    return element;
  }
}

/** The dot and the arrow before an initial state. */
function start(svg: SVGElement, { x, y, height }: Box): void {
  const middle = y + Math.min(height, 32) / 2;
  const group = add(svg, "g", {});
  add(group, "circle", { cx: x - 21, cy: middle, r: 3.5, stroke: "none" });
  add(group, "path", { d: `M${x - 18} ${middle} H${x - HEAD}`, fill: "none" });
  add(group, "path", {
    d: headOf([
      [x - 18, middle],
      [x, middle],
    ]),
    stroke: "none",
  });
}

/** The head of an arrow, at its last point. */
function headOf(points: [number, number][]): string {
  const [[x, y], [fromX, fromY]] = [points.at(-1) ?? [0, 0], points.at(-2) ?? [0, 0]];
  const [dx, dy] = [Math.sign(x - fromX), Math.sign(y - fromY)];
  const [backX, backY] = [x - 1.6 * HEAD * dx, y - 1.6 * HEAD * dy];
  return `M${x} ${y} L${backX - HEAD * dy * 0.8} ${backY - HEAD * dx * 0.8} L${backX + HEAD * dy * 0.8} ${backY + HEAD * dx * 0.8} Z`;
}

function add(parent: SVGElement, tag: string, attributes: Record<string, string | number>): SVGElement {
  const element = makeSvg(tag, attributes);
  parent.append(element);
  return element;
}
