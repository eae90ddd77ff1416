import { make, setText } from "../shared/dom.ts";
import { on } from "../shared/events.ts";
import { type AngleUnit, toAngle, toCount, toMetres } from "../shared/format.ts";
import { CLASSES } from "../shared/frames/classes.ts";
import { angleOf, READING, type Scan, type Validity } from "../shared/frames/scan.ts";
import { type Model, setTraits } from "../shared/model.ts";
import type { LaserTraits } from "./traits.ts";

/**
 * The counts of the classes that the scanner sends, each of which switches its marks on and off, and the nearest thing.
 * A class that has been counted stays, and texts keep the greatest width that they had: a live legend does not jump.
 */
export class Legend {
  readonly #items: { name: string; item: HTMLElement; count: HTMLElement; kind: Validity }[];
  readonly #nearest = make("span", "rw-nearest");

  constructor(footer: HTMLElement, model: Model<LaserTraits>, signal: AbortSignal) {
    const counts = make("span", "rw-counts");
    this.#items = CLASSES.map(({ kind, name, symbol, word, explained }) => {
      const item = make(kind === READING ? "span" : "button", `rw-class rw-class-${name}`);
      item.title = kind === READING ? explained : `${explained}. Click: marks on or off`;
      const count = make("b", "");
      item.hidden = true;
      // The space is for screen readers; the page shows none there.
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
    footer.append(counts, this.#nearest);
  }

  /**
   * @param reach metres of the picture, which set the decimals
   * @param unit in which the angle is shown
   */
  update(scan: Scan | null, shown: string[], reach: number, unit: AngleUnit): void {
    for (const { name, item, count, kind } of this.#items) {
      const rays = scan?.counts[kind] ?? 0;
      setText(count, toCount(rays));
      // A scan without a reading has none, and before the first scan nobody knows.
      if (rays || (scan && kind === READING)) item.hidden = false;
      keepWidth(count);
      if (kind !== READING) item.ariaPressed = String(shown.includes(name));
    }
    const parts: (string | HTMLElement)[] = [];
    const nearest = scan?.nearest ?? -1;
    if (scan && nearest >= 0) {
      if (scan.kinds[nearest] === READING) {
        parts.push("nearest ", make("b", "", toMetres(scan.ranges[nearest] as number, reach)));
      } else parts.push("too close");
      parts.push(
        " at ",
        make("b", "", toAngle(angleOf(scan, nearest), unit)),
        " ",
        make("b", "rw-index", `[${nearest}]`),
      );
    }
    this.#nearest.replaceChildren(...parts);
    keepWidth(this.#nearest);
  }
}

/** Never lets an element become narrower than the longest text so far, in widths of a digit. */
function keepWidth({ style, textContent }: HTMLElement): void {
  if (textContent.length > (Number.parseInt(style.minWidth, 10) || 0)) style.minWidth = `${textContent.length}ch`;
}

function toggleMark(model: Model<LaserTraits>, name: string): void {
  const shown = model.get("marks");
  setTraits(model, { marks: shown.includes(name) ? shown.filter((other) => other !== name) : [...shown, name] });
}
