import type { Box, Point, Size } from "./box.ts";
import { make, setHidden, setText } from "./dom.ts";
import { LaidOut } from "./laid_out.ts";

/** The texts of the pop-up of a ray, or of another place in a picture. */
export interface PopupWords {
  expression: string;
  distance: string;
  details: string;
  angle?: string;
  side?: string;
}

const ROWS = ["rw-popup-expression", "rw-popup-distance rw-popup-angle", "rw-popup-details rw-popup-side"];

/** The pop-up that names a ray, or another place in a picture. */
export class Popup {
  readonly element = make("div", "rw-floating rw-popup");
  /** One for each of the words, row by row. */
  readonly #places: HTMLElement[] = [];
  readonly #size: LaidOut;
  #place = (_size: Size): Point => ({ x: 0, y: 0 });

  /** @param foot stands below the words */
  constructor(parent: HTMLElement, signal: AbortSignal, ...foot: HTMLElement[]) {
    this.#size = new LaidOut(() => this.#move(), signal).of(this.element);
    for (const names of ROWS) {
      const row = make("div", "rw-popup-row");
      row.append(...names.split(" ").map((name) => make("span", name)));
      this.#places.push(...(row.children as Iterable<HTMLElement>));
      this.element.append(row);
    }
    this.element.append(...foot);
    setHidden(this.element, true);
    parent.append(this.element);
  }

  hide(): void {
    setHidden(this.element, true);
  }

  /** Shows words at the place that `place` finds for their size. */
  show(words: PopupWords, place: (size: Size) => Point): Box {
    setHidden(this.element, false);
    const texts = [words.expression, words.distance, words.angle, words.details, words.side];
    for (const [i, place] of this.#places.entries()) setText(place, texts[i] ?? "");
    this.#place = place;
    return this.#move();
  }

  #move(): Box {
    const { width, height } = this.#size;
    const { x, y } = this.#place({ width, height });
    this.element.style.transform = `translate(${Math.round(x)}px, ${Math.round(y)}px)`;
    return { x, y, width, height };
  }
}

/** Width of a card in pixels below which a pop-up covers too much of its picture. */
const NARROW = 440;

/** Puts the pop-up of a mark into a picture, or below it in a narrow card; returns true if it is below. */
export function putMarked(element: HTMLElement, picture: HTMLElement, width: number): boolean {
  const isBelow = width < NARROW;
  if (element.parentElement === null || element.classList.contains("rw-below") !== isBelow) {
    element.classList.toggle("rw-below", isBelow);
    if (isBelow) picture.after(element);
    else picture.append(element);
  }
  return isBelow;
}

/** The words of a pop-up in the order in which a screen reader reads them. */
export function toSentence({ expression, distance, angle, side, details }: PopupWords): string[] {
  return [expression, distance, angle ?? "", side ?? "", details.replaceAll(/\s*\n\s*/g, ", ").replaceAll("  ", ", ")];
}
