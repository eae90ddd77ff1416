import { copyOf, toBytes } from "../shared/bytes.ts";
import { toAge } from "../shared/format.ts";
import { decodeScan, type Scan } from "../shared/frames/scan.ts";
import { type Model, onChange, setTraits } from "../shared/model.ts";
import type { Stream } from "../shared/stream.ts";
import { Companion } from "./companion.ts";
import type { LaserTraits } from "./traits.ts";

const NOTHING = /* @__PURE__ */ new DataView(new ArrayBuffer(0));

/** The scan that the one on show is compared with: a pinned one, an earlier one, or the scan of another widget. */
export class Ghost {
  readonly #model: Model<LaserTraits>;
  readonly #stream: Stream<Scan>;
  readonly #other: Companion<Scan>;
  #decoded: { bytes: DataView; scan: Scan } | null = null;

  constructor(model: Model<LaserTraits>, stream: Stream<Scan>, redraw: () => void, signal: AbortSignal) {
    this.#model = model;
    this.#stream = stream;
    this.#other = new Companion(model, decodeScan, redraw, signal);
    const follow = () => this.#other.follow(model.get("_ghost_of") ?? "");
    onChange(model, ["_ghost_of"], follow, signal);
    follow();
  }

  /** True if a ghost is wanted. */
  get isSet(): boolean {
    return Boolean(this.#other.title !== null || this.#model.get("_ghost_ago") || toBytes(this.#model.get("_ghost")));
  }

  get scan(): Scan | null {
    if (this.#other.title !== null) return this.#other.shown;
    const bytes = this.#bytes();
    if (!bytes) return null;
    if (this.#decoded?.bytes !== bytes) this.#decoded = { bytes, scan: decodeScan(bytes) };
    return this.#decoded.scan;
  }

  /** Its source: "1.0 s ago", or the title of another widget. */
  get words(): string {
    const { title } = this.#other;
    if (title !== null) return title || "the other one";
    const [shown, { scan }] = [this.#stream.shown, this];
    // A player has no history, and scans arrive when they are read. A scan that Python chose has no number.
    if (!this.#model.get("history") || !shown?.sequence || !scan?.sequence) return "pinned";
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
    const ago = this.#model.get("_ghost_ago");
    return ago ? this.#stream.before(ago) : toBytes(this.#model.get("_ghost"));
  }
}
