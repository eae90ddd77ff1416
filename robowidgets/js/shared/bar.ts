import { make, makeButton, set, setHidden, setText } from "./dom.ts";
import { on } from "./events.ts";
import { toAge } from "./format.ts";
import type { Frame, Place, Stream } from "./stream.ts";

/** The bar under a frozen picture: it steps and drags through earlier samples, and shows their age. */
export class Bar {
  readonly root = make("div", "rw-steps");
  readonly #slider = make("input", "rw-slider");
  readonly #time = make("b", "");
  readonly #word = make("span", "rw-word");

  constructor(stream: Stream<Frame>, signal: AbortSignal) {
    const slider = this.#slider;
    slider.type = "range";
    slider.title = "What came before (, and . step)";
    slider.ariaLabel = "Sample on show";
    on(slider, "input", () => stream.seek(Number(slider.value)), signal);
    // The slider uses these keys itself; elsewhere on the card they move through the picture.
    on(slider, "keydown", (event) => /^(Arrow|Home|End)/.test(event.key) && event.stopPropagation(), signal);
    const back = makeButton("rw-step", "One sample back (,)", () => stream.step(-1), signal, "\u2039");
    const next = makeButton("rw-step", "One sample on (.)", () => stream.step(1), signal, "\u203a");
    const time = make("span", "rw-time");
    time.append(this.#time, this.#word);
    this.root.append(back, slider, next, time);
  }

  /** @param place of the sample on show in the history, or null if the history has no other sample */
  update(place: Place | null): void {
    setHidden(this.root, !place);
    if (!place) return;
    const { index, count, behind } = place;
    const isEarlier = index < count - 1;
    const age = isEarlier && behind >= 0 ? toAge(behind, 2) : "";
    this.#slider.max = String(count - 1);
    this.#slider.value = String(index);
    setText(this.#time, age ? `\u2212${age}` : isEarlier ? "earlier" : "newest");
    setText(this.#word, age && " from newest");
    const words = age ? `${age.replace(/s$/, "seconds")} before the newest` : this.#time.textContent;
    set(this.#slider, "ariaValueText", `${words}, ${index + 1} of ${count}`);
  }
}
