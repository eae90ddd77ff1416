import { copyOf, toBytes } from "../shared/bytes.ts";
import { toAge } from "../shared/format.ts";
import { type Model, onChange, setTraits } from "../shared/model.ts";
import type { Stream } from "../shared/stream.ts";
import { decodeScan, type Scan } from "./scan.ts";
import type { LaserTraits } from "./traits.ts";

const NOTHING = /* @__PURE__ */ new DataView(new ArrayBuffer(0));

/** The scan that the one on show is compared with: a pinned one, one some scans before, or that of another widget. */
export class Ghost {
  readonly #model: Model<LaserTraits>;
  readonly #stream: Stream<Scan>;
  readonly #redraw: () => void;
  readonly #signal: AbortSignal;
  #other: { id: string; model: Model<LaserTraits> | null } = { id: "", model: null };
  #decoded: { bytes: DataView; scan: Scan } | null = null;

  constructor(model: Model<LaserTraits>, stream: Stream<Scan>, redraw: () => void, signal: AbortSignal) {
    this.#model = model;
    this.#stream = stream;
    this.#redraw = redraw;
    this.#signal = signal;
    onChange(model, ["_ghost_of"], () => this.#follow(), signal);
    this.#follow();
  }

  /** Whether there is to be one. */
  get isSet(): boolean {
    const { model } = this.#other;
    return Boolean(model || this.#model.get("_ghost_ago") || toBytes(this.#model.get("_ghost")));
  }

  get scan(): Scan | null {
    const bytes = this.#bytes();
    if (!bytes) return null;
    if (this.#decoded?.bytes !== bytes) this.#decoded = { bytes, scan: decodeScan(bytes) };
    return this.#decoded.scan;
  }

  /** Where it comes from: "1.0 s ago", the title of another widget. */
  get words(): string {
    const { model } = this.#other;
    if (model) return model.get("title") || "the other one";
    const [shown, { scan }] = [this.#stream.shown, this];
    // Samples of a recording, and those that Python chose, have no number: their arrival tells nothing.
    if (!shown?.sequence || !scan?.sequence) return "pinned";
    const ms = 1000 * (shown.arrived - scan.arrived);
    return ms < 0 ? `${toAge(-ms)} later` : `${toAge(ms)} ago`;
  }

  /** Pins the scan on show, or removes the ghost. */
  toggle(): void {
    const bytes = this.#stream.bytes;
    const kept = this.isSet || !bytes ? NOTHING : new DataView(copyOf(bytes, 0, bytes.byteLength));
    setTraits(this.#model, { _ghost: kept, _ghost_ago: 0, _ghost_of: "" });
  }

  #bytes(): DataView | null {
    const { model } = this.#other;
    if (model) return toBytes(model.get("paused") ? model.get("_held") : model.get("_frame"));
    const ago = this.#model.get("_ghost_ago");
    return ago ? this.#stream.before(ago) : toBytes(this.#model.get("_ghost"));
  }

  /** Follows the widget that the trait names, which the host may have to look up. */
  async #follow(): Promise<void> {
    const id = this.#model.get("_ghost_of") ?? "";
    if (id === this.#other.id) return;
    this.#other = { id, model: null };
    this.#redraw();
    if (!id) return;
    // A widget that was closed, or is not in an exported page, leaves no ghost.
    const found = await this.#model.widget_manager.get_model(id).catch(() => null);
    if (!found || this.#other.id !== id || this.#signal.aborted) return;
    const model = found as Model<LaserTraits>;
    this.#other.model = model;
    onChange(model, ["_frame", "_held", "paused", "title"], this.#redraw, this.#signal);
    this.#redraw();
  }
}
