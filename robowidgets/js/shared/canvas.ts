import type { Point, Size } from "./box.ts";
import { make, zoomOf } from "./dom.ts";
import { on, onAbort } from "./events.ts";
import { isPrinting, onPrint } from "./print.ts";

export type Context = CanvasRenderingContext2D;

/** The size of a picture, and how many device pixels each of its pixels has. */
export interface Surface extends Size {
  ratio: number;
}

/** A canvas that stays sharp at any pixel ratio; drawn on in CSS pixels. */
export class Canvas {
  readonly context: Context;
  readonly #element = make("canvas", "rw-layer");

  constructor(parent: HTMLElement) {
    this.#element.ariaHidden = "true";
    const context = this.#element.getContext("2d");
    if (!context) throw new Error("robowidgets: no 2D canvas here");
    this.context = context;
    parent.append(this.#element);
  }

  /** Clears it for a picture of this size. */
  begin({ width, height, ratio }: Surface): Context {
    const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
    const element = this.#element;
    if (element.width !== w || element.height !== h) {
      element.width = w;
      element.height = h;
      // The box of the element may differ by a fraction of a pixel; a canvas scaled to it would be blurred.
      element.style.width = `${width}px`;
      element.style.height = `${height}px`;
    }
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.context.clearRect(0, 0, width, height);
    // Chromium prints the calls after a canvas is cleared, the clearing included, which clears the canvases below.
    // Using its pixels in between makes it print pixels.
    if (isPrinting()) make("canvas", "").getContext("2d")?.drawImage(element, 0, 0, 1, 1);
    return this.context;
  }
}

const HALO = 4;

/** Writes text, vertically centred at y; with a halo of some colour, which separates it from lines below it. */
export function write(
  context: Context,
  text: string,
  x: number,
  y: number,
  color: string,
  font: string,
  align: CanvasTextAlign,
  halo = "",
): void {
  context.font = font;
  context.textAlign = align;
  context.textBaseline = "middle";
  if (halo) {
    context.lineJoin = "round";
    context.lineWidth = HALO;
    context.strokeStyle = halo;
    context.strokeText(text, x, y);
  }
  context.fillStyle = color;
  context.fillText(text, x, y);
}

/** Begins a path with a circle. */
export function circle(context: Context, { x, y }: Point, radius: number): void {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
}

/** Adds a line to the path. */
export function line(context: Context, from: Point, to: Point): void {
  context.moveTo(from.x, from.y);
  context.lineTo(to.x, to.y);
}

/** Draws the path. */
export function stroke(context: Context, color: string, width: number): void {
  context.strokeStyle = color;
  context.lineWidth = width;
  context.stroke();
}

/** Fills the path. */
export function fill(context: Context, color: string): void {
  context.fillStyle = color;
  context.fill();
}

/** Device pixels per pixel on paper, which shows finer lines than a screen. */
const PAPER_RATIO = 3;

function screenRatio(): number {
  return isPrinting() ? Math.max(PAPER_RATIO, devicePixelRatio) : devicePixelRatio;
}

/** The size of an element, at a pixel ratio of the page or the screen's. */
export function sizeOf(element: HTMLElement, ratio = screenRatio()): Surface {
  return { width: element.clientWidth, height: element.clientHeight, ratio: ratio * zoomOf(element) };
}

/** The callbacks for the size of an element. */
interface Watcher {
  prepare: () => void;
  callback: (size: Surface) => void;
}

/**
 * The sizes of all pictures of the page. All are read before the first is drawn: to read one after a card has changed, a
 * browser would lay out all of the page again, for each card of many.
 */
class Sizes {
  readonly #watchers = new Map<Element, Watcher>();
  readonly #observer = new ResizeObserver((entries) => this.#tell(entries.map(({ target }) => target as HTMLElement)));

  watch(element: HTMLElement, watcher: Watcher): () => void {
    this.#watchers.set(element, watcher);
    this.#observer.observe(element);
    return () => {
      this.#watchers.delete(element);
      this.#observer.unobserve(element);
    };
  }

  constructor() {
    onPrint("sizes", () => this.#tell([...this.#watchers.keys()] as HTMLElement[]));
  }

  #tell(elements: HTMLElement[]): void {
    const sizes = elements.map((element) => [element, sizeOf(element)] as const);
    for (const [element, { width }] of sizes) if (width) this.#watchers.get(element)?.prepare();
    for (const [element, size] of sizes) {
      try {
        this.#watchers.get(element)?.callback(size);
      } catch (error) {
        reportError(error);
      }
    }
  }
}

const KEY: unique symbol = Symbol.for("robowidgets sizes") as never;

/** The scripts of different widgets share only this object. */
const page = globalThis as { [KEY]?: Sizes };

/**
 * Calls back with the size of an element soon, and whenever the size or the pixel ratio changes.
 *
 * @param prepare called before any picture of the page is drawn for its size: it reads sizes of the layout
 */
export function watchSize(
  element: HTMLElement,
  callback: (size: Surface) => void,
  signal: AbortSignal,
  prepare = () => {},
): void {
  const tell = () => callback(sizeOf(element));
  page[KEY] ??= new Sizes();
  onAbort(signal, page[KEY].watch(element, { prepare, callback }));
  const watchRatio = () => {
    const query = matchMedia(`(resolution: ${devicePixelRatio}dppx)`);
    const onRatio = () => {
      tell();
      watchRatio();
    };
    on(query, "change", onRatio, signal, { once: true });
  };
  watchRatio();
}
