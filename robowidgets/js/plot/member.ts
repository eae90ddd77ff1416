import { type Model, onChange, setTraits } from "../shared/model.ts";
import { join, type Member, othersOf, setFrozen, tellOthers } from "../shared/together.ts";
import type { PlotData } from "./data.ts";
import type { PlotTraits } from "./traits.ts";

/** A plot among the widgets that are frozen and released together. */
export class PlotMember implements Member {
  readonly robot = "";
  /** It has no earlier samples: all of them are on show. */
  readonly oldest = -Infinity;
  readonly #model: Model<PlotTraits>;
  readonly #data: PlotData;

  constructor(model: Model<PlotTraits>, data: PlotData, signal: AbortSignal) {
    this.#model = model;
    this.#data = data;
    join(this, signal);
    onChange(model, ["paused", "_together"], () => tellOthers(this), signal);
  }

  get group(): string {
    return this.#model.get("_together");
  }

  get paused(): boolean {
    return this.#model.get("paused");
  }

  freeze(): void {
    if (!this.paused) setTraits(this.#model, { paused: true, _frozen_at: this.#data.whole?.[1] ?? null });
  }

  release(): void {
    if (this.paused) setTraits(this.#model, { paused: false, _frozen_at: null });
  }

  /** Freezes it with the others, or releases all of them. */
  toggle(): void {
    setFrozen([this, ...othersOf(this)], !this.paused);
  }

  showAt(): void {}
}
