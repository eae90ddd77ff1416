import { make, set, setHidden, setText } from "../shared/dom.ts";

const KEYS = ["measured", "command", "limit", "peak"] as const;
type Key = (typeof KEYS)[number];
const WORDS: Record<Key, string> = { measured: "measured", command: "commanded", limit: "limits", peak: "peaks" };

/** The meaning of the marks on show, and one line about all axes. */
export class Legend {
  readonly #items = new Map<Key, HTMLElement>();
  readonly #bars = make("span", "", WORDS.measured);
  readonly #summary = make("span", "rw-summary");

  constructor(footer: HTMLElement) {
    const keys = make("span", "rw-keys");
    for (const key of KEYS) {
      const item = make("span", "rw-key-item");
      item.append(make("span", `rw-key rw-key-${key}`), key === "measured" ? this.#bars : WORDS[key]);
      this.#items.set(key, item);
      keys.append(item);
    }
    footer.append(keys, this.#summary);
  }

  /** @param bars the values of the bars, in a word */
  update(bars: string, hasCommand: boolean, hasLimits: boolean, hasPeaks: boolean, summary: string): void {
    setText(this.#bars, bars);
    this.#show("command", hasCommand);
    this.#show("limit", hasLimits);
    this.#show("peak", hasPeaks);
    setText(this.#summary, summary);
    set(this.#summary, "title", summary);
  }

  #show(key: Key, shown: boolean): void {
    const item = this.#items.get(key);
    if (item) setHidden(item, !shown);
  }
}
