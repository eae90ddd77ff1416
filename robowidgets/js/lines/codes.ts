import { type Model, onChange } from "../shared/model.ts";
import type { LinesTraits, VersionCode } from "./traits.ts";

/** Versions that are kept. */
const MOST = 50;

/** The sources of the last versions, so that a frozen step is shown in its own. */
export class Codes {
  readonly #model: Model<LinesTraits>;
  readonly #known = new Map<string, VersionCode>();

  constructor(model: Model<LinesTraits>, signal: AbortSignal) {
    this.#model = model;
    this.#keep();
    onChange(model, ["_code"], () => this.#keep(), signal);
  }

  /** The source of a version; the newest for one that is not kept. */
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
