import { make, makeButton, set, setHidden } from "../shared/dom.ts";
import { on } from "../shared/events.ts";
import { labelOf } from "./text.ts";
import type { ViewName } from "./traits.ts";

const VIEWS: [ViewName, string][] = [
  ["above", "Above"],
  ["side", "Side"],
  ["behind", "Behind"],
  ["rows", "Rows"],
];

/** Actions of the user on the picture. */
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
   * @param fields the fields that may colour the points
   * @param hasRows true if the points of the cloud lie in rows
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
