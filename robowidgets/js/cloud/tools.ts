import type { Point } from "../shared/box.ts";
import { isDragged, make, makeButton, pointIn, set, setHidden } from "../shared/dom.ts";
import { on } from "../shared/events.ts";
import { labelOf } from "./text.ts";
import type { ViewName } from "./traits.ts";

const VIEWS: [ViewName, string][] = [
  ["above", "From above"],
  ["side", "From the side"],
  ["behind", "From behind"],
  ["rows", "In rows"],
];

/** What a person does to the picture. */
export interface CloudActs {
  onView(view: ViewName): void;
  onColor(field: string): void;
  onSelect(): void;
  onFit(): void;
  onZoom(direction: -1 | 1): void;
}

/** The buttons of a cloud, which stand before the one that freezes. */
export class Tools {
  readonly all: HTMLElement[];
  readonly #view = make("select", "rw-button rw-cloud-choice");
  readonly #color = make("select", "rw-button rw-cloud-choice");
  readonly #select: HTMLButtonElement;
  readonly #fit: HTMLButtonElement;
  readonly #zooms: HTMLButtonElement[];
  #fields = "";

  constructor(acts: CloudActs, signal: AbortSignal) {
    this.#view.ariaLabel = "From where the points are seen";
    this.#view.title = "From where the points are seen (v)";
    for (const [value, label] of VIEWS) this.#view.append(new Option(label, value));
    on(this.#view, "change" as "input", () => acts.onView(this.#view.value as ViewName), signal);
    this.#color.ariaLabel = "What colours the points";
    this.#color.title = "What colours the points";
    on(this.#color, "change" as "input", () => acts.onColor(this.#color.value), signal);
    const farther = makeButton("rw-zoom", "Zoom out (\u2212)", () => acts.onZoom(1), signal, "\u2212");
    const closer = makeButton("rw-zoom", "Zoom in (+)", () => acts.onZoom(-1), signal, "+");
    this.#fit = makeButton("rw-fit", "Show all points (0)", () => acts.onFit(), signal, "Fit");
    const label = "Select points by a box: drag over them (b), or with Shift at any time";
    this.#select = makeButton("rw-cloud-select", label, () => acts.onSelect(), signal, "Box");
    this.#zooms = [farther, closer];
    this.all = [this.#view, this.#color, farther, closer, this.#fit, this.#select];
  }

  /**
   * @param fields what may colour the points
   * @param hasRows whether the cloud lies in rows
   */
  update(view: ViewName, color: string, fields: string[], hasRows: boolean, isFitted: boolean, isBox: boolean): void {
    const rows = this.#view.options[this.#view.options.length - 1] as HTMLOptionElement;
    set(rows, "disabled", !hasRows && view !== "rows");
    const key = fields.join("\n");
    if (key !== this.#fields) {
      this.#fields = key;
      this.#color.replaceChildren(...fields.map((name) => new Option(labelOf(name), name)));
    }
    for (const [select, value] of [
      [this.#view, view],
      [this.#color, color],
    ] as const) {
      if (select.value !== value) select.value = value;
    }
    const isFlat = view !== "rows";
    for (const one of [...this.#zooms, this.#fit]) setHidden(one, !isFlat);
    set(this.#fit, "disabled", isFitted);
    setHidden(this.#select, !isFlat);
    set(this.#select, "ariaPressed", String(isBox));
  }
}

/** What drags over the picture do. */
export interface Dragged {
  /** What a press at a place begins. */
  startsAt(at: Point, isShifted: boolean): "move" | "box" | "band" | null;
  onMove(dx: number, dy: number): void;
  onBox(from: Point, to: Point): void;
  onBand(from: Point, to: Point): void;
  onTap(event: MouseEvent): void;
}

/** Has drags of a mouse or a pen move the picture, or draw bounds; a finger does that too where it selects. */
export function watchDrags(picture: HTMLElement, target: Dragged, signal: AbortSignal): void {
  let drag: { pointer: number; from: Point; last: Point; hasMoved: boolean; kind: "move" | "box" | "band" } | null =
    null;
  let moved = false;
  const isOver = ({ target: on }: Event) => on instanceof Element && on.closest(".rw-over") !== null;
  const onDown = (event: PointerEvent) => {
    moved = false;
    if (event.button !== 0 || isOver(event)) return;
    const from = pointIn(picture, event);
    const kind = target.startsAt(from, event.shiftKey);
    // A finger scrolls the page, unless it draws.
    if (!kind || (event.pointerType === "touch" && kind === "move")) return;
    drag = { pointer: event.pointerId, from, last: from, hasMoved: false, kind };
  };
  const onMove = (event: PointerEvent) => {
    if (!drag || event.pointerId !== drag.pointer) return;
    const at = pointIn(picture, event);
    if (!drag.hasMoved && !isDragged(drag.from, at)) return;
    if (!drag.hasMoved) picture.setPointerCapture(event.pointerId);
    drag.hasMoved = moved = true;
    if (drag.kind === "move") target.onMove(at.x - drag.last.x, at.y - drag.last.y);
    else if (drag.kind === "box") target.onBox(drag.from, at);
    else target.onBand(drag.from, at);
    drag.last = at;
  };
  const onEnd = () => {
    drag = null;
  };
  on(picture, "pointerdown", onDown, signal);
  on(picture, "pointermove", onMove, signal);
  on(picture, "pointerup", onEnd, signal);
  on(picture, "pointercancel", onEnd, signal);
  on(picture, "click", (event) => !moved && !isOver(event) && target.onTap(event), signal);
}
