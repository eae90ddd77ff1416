import { type Model, onChange } from "../shared/model.ts";
import type { MachineTraits, VersionOutline } from "./traits.ts";

/** Versions that are kept. */
const MOST = 50;

/** The outlines of the last versions, so that a frozen moment is drawn as it was. */
export class Outlines {
  readonly #model: Model<MachineTraits>;
  readonly #known = new Map<string, VersionOutline>();

  constructor(model: Model<MachineTraits>, signal: AbortSignal) {
    this.#model = model;
    this.#keep();
    onChange(model, ["_outline"], () => this.#keep(), signal);
  }

  /** The outline of a version; the newest for an unknown one. */
  of(key = ""): VersionOutline {
    return this.#known.get(key) ?? this.#model.get("_outline");
  }

  #keep(): void {
    const outline = this.#model.get("_outline");
    this.#known.set(outline.key ?? "", outline);
    const [oldest] = this.#known.keys();
    if (this.#known.size > MOST && oldest !== undefined) this.#known.delete(oldest);
  }
}
