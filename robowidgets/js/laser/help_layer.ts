import { make, makeButton, set, setHidden } from "../shared/dom.ts";
import { on } from "../shared/events.ts";
import type { Host, Layer } from "./layer.ts";

/** Actions of the user, and their effects. */
const KEYS = [
  ["drag along an arc", "select rays"],
  ["t", "type rays"],
  ["[ ]", "choose an edge; arrows move it"],
  ["Enter", "keep the rays under a name"],
  ["Delete", "remove them"],
  ["c", "copy code"],
  ["Tab", "next sector or pin"],
  ["\u2190 \u2192", "walk the rays"],
  ["m", "nearest ray"],
  ["f", "formula of the angle"],
  ["r", "degrees or radians"],
  ["a", "angles of the robot or the scanner"],
  ["g", "ghost to compare with"],
  ["+ \u2212", "zoom"],
  ["space", "freeze"],
  [", .", "step while frozen"],
  ["Esc", "put back, deselect"],
] as const;

/** The list of keys, which a button and "?" unfold over the picture. */
export class HelpLayer implements Layer {
  readonly traits = [];
  readonly button: HTMLButtonElement;
  readonly #list = make("dl", "rw-floating rw-over rw-key-list");

  constructor({ card, signal }: Host) {
    this.button = makeButton("rw-help", "What to press (?)", () => this.#toggle(), signal, "?");
    this.#list.ariaLabel = "keys";
    for (const [key, words] of KEYS) this.#list.append(make("dt", "", key), make("dd", "", words));
    on(this.#list, "click", () => this.#unfold(false), signal);
    card.picture.append(this.#list);
    this.#unfold(false);
  }

  painters(): Record<string, never> {
    return {};
  }

  onKey({ key }: KeyboardEvent): boolean {
    if (key !== "?" && (key !== "Escape" || this.#list.hidden)) return false;
    this.#toggle();
    return true;
  }

  #toggle(): void {
    this.#unfold(Boolean(this.#list.hidden));
  }

  #unfold(isOpen: boolean): void {
    setHidden(this.#list, !isOpen);
    set(this.button, "ariaExpanded", String(isOpen));
  }
}
