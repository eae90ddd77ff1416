import { make, makeButton, setHidden, setText } from "../shared/dom.ts";
import type { Scan } from "../shared/frames/scan.ts";
import { type Model, setTraits } from "../shared/model.ts";
import type { About } from "../shared/traits.ts";
import { angleFormula } from "./formula.ts";
import type { LaserTraits } from "./traits.ts";

const LINES = ["names", "numbers", "result", "wrapped"];

/** The foot of the pop-up of the pinned ray: the formula of its angle, and the unit of angles. */
export class FormulaFoot {
  readonly element = make("div", "rw-popup-foot");
  readonly #model: Model<LaserTraits>;
  readonly #unfold: HTMLButtonElement;
  readonly #unit: HTMLButtonElement;
  readonly #formula = make("div", "rw-formula");
  readonly #lines = LINES.map((name) => make("div", `rw-formula-${name}`));
  #key = "";

  constructor(model: Model<LaserTraits>, signal: AbortSignal) {
    this.#model = model;
    this.#unfold = makeButton("rw-unfold", "", () => this.toggleFormula(), signal, "Formula");
    this.#unit = makeButton("rw-angle-unit", "", () => this.toggleUnit(), signal);
    this.#unfold.title = "How the angle is worked out (f)";
    // Their accessible names are their texts.
    for (const button of [this.#unfold, this.#unit]) button.ariaLabel = null;
    const row = make("div", "rw-popup-row rw-over");
    row.append(this.#unfold, this.#unit);
    this.#formula.append(...this.#lines);
    this.element.append(row, this.#formula);
  }

  toggleFormula(): void {
    setTraits(this.#model, { formula: !this.#model.get("formula") });
  }

  toggleUnit(): void {
    setTraits(this.#model, { angle_unit: this.#model.get("angle_unit") === "rad" ? "deg" : "rad" });
  }

  update(scan: Scan, index: number, about: About): void {
    setHidden(this.element, index >= scan.count);
    const { mount, angle_offset: offset = 0 } = about;
    const isOwn = this.#model.get("own_angles");
    const [isOpen, unit] = [this.#model.get("formula"), this.#model.get("angle_unit")];
    this.#unfold.ariaExpanded = String(isOpen);
    setText(this.#unit, unit === "rad" ? "in degrees" : "in radians");
    this.#unit.title = `Show all angles in ${unit === "rad" ? "degrees" : "radians"} (r)`;
    setHidden(this.#formula, !isOpen);
    const key = [isOpen, unit, scan.angleMin, scan.angleIncrement, index, isOwn, JSON.stringify(mount), offset].join();
    if (!isOpen || this.element.hidden || key === this.#key) return;
    this.#key = key;
    const { names, numbers, radians, degrees, wrapped } = angleFormula(scan, index, offset, mount, isOwn);
    const strong = (text: string, isStrong: boolean) => (isStrong ? make("b", "", text) : text);
    const result = ["=\u00A0", strong(radians, unit === "rad"), " =\u00A0", strong(degrees, unit === "deg")];
    for (const [i, parts] of [[names], [numbers], result, [wrapped]].entries()) {
      this.#lines[i]?.replaceChildren(...parts);
    }
  }
}
