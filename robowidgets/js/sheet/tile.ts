import { Canvas, type Surface } from "../shared/canvas.ts";
import { make, setText } from "../shared/dom.ts";
import type { Theme } from "../shared/theme.ts";
import { type Cut, drawPicture } from "./draw.ts";
import { COLUMNS, cellOf, type Moment } from "./order.ts";
import type { Picture } from "./pictures.ts";

/** Pixels of the texts below the picture of a tile. */
const TEXTS = 37;

/** The state of a moment among the others. */
export interface Standing {
  place: number;
  count: number;
  isPicked: boolean;
  isFalse: boolean;
  isOpen: boolean;
  /** The name of its span, or "". */
  label: string;
}

/** An element for one moment, a tile or a row, which is used again for another moment after it is scrolled away. */
export abstract class Item {
  readonly element: HTMLElement;
  moment: Moment | null = null;
  protected readonly label = make("span", "rw-sheet-label");
  /** True if it has to be painted. */
  isStale = true;
  #at = "";

  constructor(className: string) {
    this.element = make("div", `rw-sheet-item ${className}`);
    this.element.role = "option";
  }

  /** Shows a moment; returns true if it is another one. */
  show(moment: Moment, standing: Standing): void {
    if (this.moment !== moment) {
      this.moment = moment;
      this.isStale = true;
      this.element.dataset.number = String(moment.number);
      this.write(moment);
    }
    const { isPicked, isFalse, isOpen, place, count, label: name } = standing;
    setText(this.label, name);
    this.element.classList.toggle("rw-picked", isPicked);
    this.element.classList.toggle("rw-false", isFalse);
    this.element.classList.toggle("rw-open", isOpen);
    const value = moment.nearest === null ? "" : `${moment.nearest.toFixed(2)} metres at index ${moment.index}`;
    const words = [name, value, moment.file, `${moment.time.toFixed(1)} seconds`, `${place + 1} of ${count}`];
    const label = [...words, isFalse ? "false find" : ""].filter(Boolean).join(", ");
    if (this.element.ariaLabel !== label) this.element.ariaLabel = label;
    if (this.element.ariaSelected !== String(isPicked)) this.element.ariaSelected = String(isPicked);
  }

  place(x: number, y: number, width: number, height: number): void {
    const at = [x, y, width, height].join();
    if (this.#at === at) return;
    this.#at = at;
    const { style } = this.element;
    style.transform = `translate(${x}px, ${y}px)`;
    style.width = `${width}px`;
    style.height = `${height}px`;
  }

  /**
   * Hides it until it is used for another moment: removing it would make the browser check the rules of the whole page.
   */
  putAside(): void {
    this.moment = null;
    this.#at = "";
    this.element.style.transform = "translate(-9999px, 0)";
  }

  protected abstract write(moment: Moment): void;
  abstract paint(picture: Picture | undefined, cut: Cut, size: Surface, theme: Theme): void;
}

/** A moment as a small picture, with its value, index, file and time below it. */
export class Tile extends Item {
  readonly #canvas: Canvas;
  readonly #value = make("b", "rw-sheet-value");
  readonly #index = make("span", "rw-sheet-index");
  readonly #file = make("span", "rw-sheet-file");
  readonly #time = make("span", "rw-sheet-time");

  constructor() {
    super("rw-sheet-tile");
    this.#canvas = new Canvas(this.element);
    this.element.append(this.#value, this.#index, this.#file, this.#time, this.label);
  }

  protected override write(moment: Moment): void {
    const { nearest, index, file, path, time, silent } = moment;
    setText(this.#value, nearest === null ? cellOf(moment, "value") : `${nearest.toFixed(2)} m`);
    setText(this.#index, index === null ? "" : `[${index}]`);
    setText(this.#file, toShort(file));
    setText(this.#time, `${time.toFixed(1)} s`);
    this.element.title = silent ? `${path}: nothing on ${silent}` : path;
  }

  override paint(picture: Picture | undefined, cut: Cut, size: Surface, theme: Theme): void {
    const context = this.#canvas.begin(size);
    if (!picture) return;
    const box = { x: 4, y: 4, width: size.width - 8, height: size.height - TEXTS - 6 };
    drawPicture(context, picture, box, cut, this.moment?.held ?? 0, theme);
    if (this.moment?.nearest === null && picture.form !== "words" && picture.words) setText(this.#value, picture.words);
  }
}

/** A moment as a row of the table. */
export class Row extends Item {
  readonly #cells = COLUMNS.map(({ name, isNumber }) =>
    make("span", `rw-sheet-cell rw-sheet-of-${name}${isNumber ? " rw-sheet-number" : ""}`),
  );
  readonly #words = make("span", "");

  constructor() {
    super("rw-sheet-row");
    const last = make("span", "rw-sheet-cell rw-sheet-words");
    last.append(this.label, this.#words);
    this.element.append(...this.#cells, last);
  }

  protected override write(moment: Moment): void {
    for (const [i, { name }] of COLUMNS.entries()) setText(this.#cells[i] as HTMLElement, cellOf(moment, name));
    setText(this.#words, moment.silent && `nothing on ${moment.silent}`);
    this.element.title = moment.path;
  }

  override paint(picture: Picture | undefined): void {
    if (picture?.words) setText(this.#words, picture.words);
  }
}

/** The name of a file without its extension. */
function toShort(file: string): string {
  return file.replace(/\.[^./]+$/, "");
}
