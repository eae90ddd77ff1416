import { make, setHidden, setText } from "../shared/dom.ts";
import { toAge, toCount, toMetres, toShortMetres } from "../shared/format.ts";
import { CLASSES } from "../shared/frames/classes.ts";
import { nearestOf } from "../shared/frames/ring.ts";
import { READING, type Validity } from "../shared/frames/scan.ts";
import type { Cone } from "./cones.ts";

/** The number of sensors of each class, the silent ones, and the nearest thing. */
export class Footer {
  readonly #items: { kind: Validity; item: HTMLElement; count: HTMLElement }[];
  readonly #silent = make("span", "rw-sonar-silent");
  readonly #near = make("b", "rw-sonar-near");
  readonly #nearest = make("span", "rw-nearest");
  /** Words for the nearest thing: a word, its distance, its sensor and its index. */
  readonly #words = [make("span", ""), make("b", ""), make("span", ""), make("b", "rw-index")] as const;

  constructor(element: HTMLElement) {
    const counts = make("span", "rw-counts");
    this.#items = CLASSES.map(({ kind, name, symbol, word, explained }) => {
      const item = make("span", `rw-class rw-class-${name}`);
      item.title = explained;
      const count = make("b", "");
      const glyph = make("span", "rw-symbol", symbol);
      glyph.ariaHidden = "true";
      item.append(glyph, count, " ", make("span", "", word));
      item.hidden = true;
      counts.append(item);
      return { kind, item, count };
    });
    counts.append(this.#silent);
    const end = make("span", "rw-sonar-end");
    this.#nearest.append(...this.#words);
    end.append(this.#near, this.#nearest);
    element.append(counts, end);
  }

  update(cones: Cone[], near: number | null, reach: number): void {
    const live = cones.filter(({ hasCome, isSilent }) => hasCome && !isSilent);
    for (const { kind, item, count } of this.#items) {
      const found = live.filter(({ sonar }) => sonar.kind === kind).length;
      setText(count, toCount(found));
      // A class that has been counted stays: a live legend does not jump.
      if (found || (cones.length && kind === READING)) setHidden(item, false);
    }
    const silent = cones.filter(({ hasCome, isSilent }) => isSilent || !hasCome);
    setText(this.#silent, silent.length ? `\u25CC ${listed(silent.map(wordsOf))}` : "");
    const alarms = live.filter(({ isNear }) => isNear).map(({ name }) => name);
    setText(this.#near, alarms.length ? `\u25B2 ${listed(alarms)} below ${toShortMetres(near ?? 0)}` : "");
    const nearest = live[nearestOf(live.map(({ sonar }) => sonar))];
    const isReading = nearest?.sonar.kind === READING;
    const [word, distance, name, index] = this.#words;
    setText(word, !nearest ? "" : isReading ? "nearest " : "too close");
    setText(distance, nearest && isReading ? toMetres(nearest.sonar.range, reach) : "");
    setText(name, nearest ? ` ${nearest.name} ` : "");
    setText(index, nearest ? `[${nearest.index}]` : "");
  }
}

/** A silent sensor, and the time of its silence. */
function wordsOf({ name, hasCome, age }: Cone): string {
  return hasCome ? `${name} silent for ${toAge(1000 * age, 0)}` : `no data of ${name} yet`;
}

/** The first two of several texts, and the number of the others. */
function listed(texts: string[]): string {
  const more = texts.length - 2;
  return texts.slice(0, 2).join(", ") + (more > 0 ? ` and ${more} more` : "");
}
