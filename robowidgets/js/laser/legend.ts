import { make, set, setHidden, setText } from "../shared/dom.ts";
import { on } from "../shared/events.ts";
import { type AngleUnit, toAngle, toCount, toMetres } from "../shared/format.ts";
import { CLASSES } from "../shared/frames/classes.ts";
import { angleOf, READING, type Scan, type Validity } from "../shared/frames/scan.ts";
import { type Model, setTraits } from "../shared/model.ts";
import type { ToShown } from "./mount.ts";
import type { LaserTraits } from "./traits.ts";

/**
 * The counts of the classes that the scanner sends, which are buttons for their marks, and the nearest thing. A class
 * that has been counted stays, and texts keep their greatest width: a live legend does not jump.
 */
export class Legend {
  readonly #items: { name: string; item: HTMLElement; count: HTMLElement; kind: Validity }[];
  readonly #nearest = make("span", "rw-nearest");
  /** Type, distance, angle and ray of the nearest thing, with the words between them. */
  readonly #words = (["span", "b", "span", "b", "span", "b"] as const).map((tag) => make(tag, ""));

  constructor(footer: HTMLElement, model: Model<LaserTraits>, signal: AbortSignal) {
    const counts = make("span", "rw-counts");
    this.#items = CLASSES.map(({ kind, name, symbol, word, explained }) => {
      const item = make(kind === READING ? "span" : "button", `rw-class rw-class-${name}`);
      item.title = kind === READING ? explained : `${explained}. Click: marks on or off`;
      const count = make("b", "");
      item.hidden = true;
      // The space is for screen readers; it is invisible on the page.
      const glyph = make("span", "rw-symbol", symbol);
      glyph.ariaHidden = "true";
      item.append(glyph, count, " ", make("span", "", word));
      if (item instanceof HTMLButtonElement) {
        item.type = "button";
        on(item, "click", () => toggleMark(model, name), signal);
      }
      counts.append(item);
      return { name, item, count, kind };
    });
    this.#words.at(-1)?.classList.add("rw-index");
    this.#nearest.append(...this.#words);
    footer.append(counts, this.#nearest);
  }

  /**
   * @param reach metres of the picture, which set the decimals
   * @param unit in which the angle is shown
   * @param toShown converts to the angle on show
   */
  update(scan: Scan | null, shown: string[], reach: number, unit: AngleUnit, toShown: ToShown): void {
    for (const { name, item, count, kind } of this.#items) {
      const rays = scan?.counts[kind] ?? 0;
      setText(count, toCount(rays));
      // A scan without a reading has no nearest thing; before the first scan it is unknown.
      if (rays || (scan && kind === READING)) setHidden(item, false);
      keepWidth(count);
      if (kind !== READING) set(item, "ariaPressed", String(shown.includes(name)));
    }
    const texts: string[] = [];
    const nearest = scan?.nearest ?? -1;
    if (scan && nearest >= 0) {
      const isReading = scan.kinds[nearest] === READING;
      texts.push(
        isReading ? "nearest " : "too close",
        isReading ? toMetres(scan.ranges[nearest] as number, reach) : "",
      );
      texts.push(" at ", toAngle(toShown(angleOf(scan, nearest)), unit), " ", `[${nearest}]`);
    }
    for (const [i, element] of this.#words.entries()) setText(element, texts[i] ?? "");
    keepWidth(this.#nearest);
  }
}

/** Keeps an element at least as wide as its longest text so far, in widths of a digit. */
function keepWidth({ style, textContent }: HTMLElement): void {
  if (textContent.length > (Number.parseInt(style.minWidth, 10) || 0)) style.minWidth = `${textContent.length}ch`;
}

function toggleMark(model: Model<LaserTraits>, name: string): void {
  const shown = model.get("marks");
  setTraits(model, { marks: shown.includes(name) ? shown.filter((other) => other !== name) : [...shown, name] });
}
