import { type Model, onChange, onMessage } from "../shared/model.ts";
import type { SheetTraits } from "./traits.ts";

/** The picture of a moment on a tile; robowidgets/fleet/_pictures.py packs it. */
export interface Picture {
  form: "rays" | "line" | "words";
  /** For rays, see `LIT`; for a line, its numbers. */
  values: Uint16Array | Float32Array;
  /** For rays, the first angle and the increment, in radians; for a line, its ends in seconds from the start. */
  facts: [number, number];
  /** Metres of a step of rays. */
  step: number;
  /** The compared values, or the event. */
  words: string;
}

/** The bit of a ray for which the condition holds; the other bits are steps of distance, 0 without a reading. */
export const LIT = 0x8000;

const HEAD = 24;
const FORMS = ["words", "rays", "line", "words"] as const;
const WIDTH = { rays: 2, line: 4, words: 1 } as const;
/** Pictures that a page keeps; 25 MB of them. */
const MOST = 30_000;

/** Pictures by the numbers of their moments. */
export function unpack(view: DataView): Map<number, Picture> {
  const found = new Map<number, Picture>();
  for (let at = 0; at + HEAD <= view.byteLength; ) {
    const form = FORMS[view.getUint8(at + 4)] ?? "words";
    const size = view.getUint16(at + 6, true) * WIDTH[form];
    const words = view.getUint16(at + 20, true);
    const body = view.byteOffset + at + HEAD;
    const bytes = view.buffer.slice(body, body + size);
    found.set(view.getUint32(at, true), {
      form,
      values: form === "line" ? new Float32Array(bytes) : form === "rays" ? new Uint16Array(bytes) : new Uint16Array(),
      facts: [view.getFloat32(at + 8, true), view.getFloat32(at + 12, true)],
      step: view.getFloat32(at + 16, true),
      words: new TextDecoder().decode(new Uint8Array(view.buffer, body + size, words)),
    });
    at += HEAD + 4 * Math.ceil((size + words) / 4);
  }
  return found;
}

/** The pictures that a page has of one sheet. */
export class Pictures {
  readonly #kept = new Map<number, Picture>();
  readonly #listeners = new Set<() => void>();

  constructor(model: Model<SheetTraits>, signal: AbortSignal) {
    const take = (view: DataView) => {
      for (const [number, picture] of unpack(view)) this.#kept.set(number, picture);
      for (const number of this.#kept.keys()) {
        if (this.#kept.size <= MOST) break;
        this.#kept.delete(number);
      }
      for (const listener of this.#listeners) listener();
    };
    onMessage(model, (message: { pictures?: number }, [buffer]) => message.pictures && buffer && take(buffer), signal);
    onChange(model, ["_pictures"], () => take(model.get("_pictures")), signal);
    take(model.get("_pictures"));
    // Python sends all of them to a new page.
    model.send({ new: true });
  }

  get(number: number): Picture | undefined {
    return this.#kept.get(number);
  }

  /** Calls back when pictures arrive, until the signal aborts. */
  listen(listener: () => void, signal: AbortSignal): void {
    this.#listeners.add(listener);
    signal.addEventListener("abort", () => this.#listeners.delete(listener), { once: true });
  }
}
