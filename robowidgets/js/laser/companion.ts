import { toBytes } from "../shared/bytes.ts";
import { type Model, onChange } from "../shared/model.ts";
import type { Frame } from "../shared/stream.ts";
import type { About, SampleTraits } from "../shared/traits.ts";

/** The sample that another widget of the page shows, frozen or live. */
export class Companion<F extends Frame, T extends SampleTraits = SampleTraits> {
  readonly #host: Model<unknown>;
  readonly #decode: (bytes: DataView) => F;
  readonly #onChange: () => void;
  readonly #signal: AbortSignal;
  #id = "";
  #model: Model<T> | null = null;
  #decoded: { bytes: DataView; frame: F } | null = null;

  constructor(host: Model<unknown>, decode: (bytes: DataView) => F, onChange: () => void, signal: AbortSignal) {
    this.#host = host;
    this.#decode = decode;
    this.#onChange = onChange;
    this.#signal = signal;
  }

  /** Follows a widget by the name of its model, which the host may have to look up; "" for none. */
  async follow(id: string): Promise<void> {
    if (id === this.#id) return;
    [this.#id, this.#model] = [id, null];
    this.#onChange();
    if (!id) return;
    // A widget that was closed, or is not in an exported page, shows nothing.
    const found = await this.#host.widget_manager.get_model(id).catch(() => null);
    if (!found || this.#id !== id || this.#signal.aborted) return;
    this.#model = found as Model<T>;
    onChange(this.#model, ["_frame", "_frozen_frame", "_about", "paused", "title"], this.#onChange, this.#signal);
    this.#onChange();
  }

  /** Null without a widget. */
  get title(): string | null {
    return this.#model?.get("title") ?? null;
  }

  /** Its traits; null without a widget. */
  get model(): Model<T> | null {
    return this.#model;
  }

  /** Facts about its sample, from Python. */
  get about(): About {
    return this.#model?.get("_about") ?? {};
  }

  /** Null without a widget, or before its first sample. */
  get shown(): F | null {
    const bytes = this.#model && toBytes(this.#model.get(this.#model.get("paused") ? "_frozen_frame" : "_frame"));
    if (!bytes) return null;
    if (this.#decoded?.bytes !== bytes) this.#decoded = { bytes, frame: this.#decode(bytes) };
    return this.#decoded.frame;
  }
}
