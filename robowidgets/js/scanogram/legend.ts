import type { Card } from "../shared/card.ts";
import { make, makeButton, setHidden, setText } from "../shared/dom.ts";
import { toMetres } from "../shared/format.ts";
import { CLASSES } from "../shared/frames/classes.ts";
import { READING } from "../shared/frames/scan.ts";
import type { Theme } from "../shared/theme.ts";
import type { Whole } from "./data.ts";
import { classColors, distanceColors } from "./palette.ts";
import { toShare } from "./text.ts";

/** Width of a card whose header has room for the legend. */
const WIDE = 560;

/**
 * The scale of the colours, the share of each class, the time cursor and the selection: in the header, or below the
 * picture if the header has no room.
 */
export class Legend {
  readonly #card: Card;
  readonly #key = make("span", "rw-scanogram-key");
  readonly #state = make("span", "rw-scanogram-state");
  readonly #scale = make("span", "rw-scanogram-scale");
  readonly #near = make("b", "");
  readonly #far = make("b", "");
  readonly #bar = make("span", "rw-scanogram-scale-bar");
  readonly #classes = make("span", "rw-counts");
  readonly #time = make("b", "");
  readonly #selected = make("span", "rw-scanogram-selected");
  readonly #clear: HTMLButtonElement;

  constructor(card: Card, onClear: () => void, signal: AbortSignal) {
    this.#card = card;
    this.#clear = makeButton("rw-scanogram-clear", "Clear the selection (Escape)", onClear, signal, "\u00D7");
    this.#scale.append(this.#near, this.#bar, this.#far);
    this.#key.append(this.#scale, this.#classes);
    // The picture shows the time in pixels only.
    const cursor = make("span", "rw-scanogram-cursor rw-unseen", "t ");
    cursor.append(this.#time);
    this.#state.append(this.#selected, this.#clear, cursor);
  }

  /** Puts it into a place with room. */
  place(hasHeader: boolean, hasFooter: boolean, width: number): void {
    const { header, controls, footer } = this.#card;
    const isAbove = hasHeader && width >= WIDE;
    setHidden(footer, !hasFooter || isAbove);
    if (!isAbove && this.#key.parentNode !== footer) footer.append(this.#key, this.#state);
    if (isAbove && this.#key.parentNode !== header) header.insertBefore(this.#state, controls).after(this.#key);
    setHidden(this.#key, !hasFooter);
    setHidden(this.#state, !hasFooter);
  }

  drawKey(whole: Whole | null, [near, far]: [number, number], theme: Theme): void {
    setHidden(this.#scale, whole === null);
    const all = (whole?.counts ?? []).reduce((sum, count) => sum + count, 0);
    setText(this.#near, toMetres(near, far));
    setText(this.#far, toMetres(far, far));
    this.#bar.style.background = `linear-gradient(to right, ${distanceColors(theme.dark).join(",")})`;
    const shown = CLASSES.filter(({ kind }) => kind !== READING && (whole?.counts[kind] ?? 0) > 0);
    const colors = classColors(theme);
    this.#classes.replaceChildren(
      ...shown.map(({ kind, word, explained }) => {
        const item = make("span", "rw-class");
        item.title = explained;
        const swatch = make("span", "rw-scanogram-swatch");
        swatch.style.background = colors[kind] ?? "";
        item.append(swatch, make("b", "", toShare(whole?.counts[kind] ?? 0, all)), make("span", "rw-class-word", word));
        return item;
      }),
    );
  }

  drawState(time: string, selection: string): void {
    setText(this.#time, time);
    setText(this.#selected, selection);
    setHidden(this.#clear, !selection);
  }
}
