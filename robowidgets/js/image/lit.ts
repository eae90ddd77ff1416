import { type Model, onChange, setTraits } from "../shared/model.ts";

interface Pointed {
  /** Index of the ray under the pointer. */
  hovered: number | null;
}

/** The ray under the pointer, in the picture or in the laser that shows the same scan. */
export class Lit {
  readonly #host: Model<unknown>;
  readonly #onChange: () => void;
  readonly #signal: AbortSignal;
  #id = "";
  #laser: Model<Pointed> | null = null;
  #own: number | null = null;

  constructor(host: Model<unknown>, callback: () => void, signal: AbortSignal) {
    this.#host = host;
    this.#onChange = callback;
    this.#signal = signal;
  }

  /** Follows a laser by the name of its model; "" for none. */
  async follow(id: string): Promise<void> {
    if (id === this.#id) return;
    [this.#id, this.#laser] = [id, null];
    if (!id) return;
    // A widget that was closed, or is not in an exported page, lights nothing.
    const found = await this.#host.widget_manager.get_model(id).catch(() => null);
    if (!found || this.#id !== id || this.#signal.aborted) return;
    this.#laser = found as Model<Pointed>;
    onChange(this.#laser, ["hovered"], this.#onChange, this.#signal);
    this.#onChange();
  }

  get index(): number | null {
    return this.#own ?? this.#laser?.get("hovered") ?? null;
  }

  /** Lights a ray in both, or none. */
  light(index: number | null): void {
    if (index === this.#own) return;
    this.#own = index;
    if (this.#laser) setTraits(this.#laser, { hovered: index });
  }
}
