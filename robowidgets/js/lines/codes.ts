import { type Model, onChange } from "../shared/model.ts";
import type { LinesTraits, VersionCode } from "./traits.ts";

/** The maximum number of stored versions. */
const MOST = 50;

/** The sources of the last versions. A frozen step is shown in the source of its version. */
export class Codes {
  readonly #model: Model<LinesTraits>;
  readonly #known = new Map<string, VersionCode>();

  constructor(model: Model<LinesTraits>, signal: AbortSignal) {
    this.#model = model;
    this.#keep();
    onChange(model, ["_code"], () => this.#keep(), signal);
  }

  /** Returns the source of a version, or the newest source if that version is not stored. */
  of(key = ""): VersionCode {
    return this.#known.get(key) ?? this.#model.get("_code");
  }

  #keep(): void {
    const code = this.#model.get("_code");
    this.#known.set(code.key ?? "", code);
    const [oldest] = this.#known.keys();
    if (this.#known.size > MOST && oldest !== undefined) this.#known.delete(oldest);
  }
}
