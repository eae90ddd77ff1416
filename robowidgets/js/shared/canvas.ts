import { make } from "./dom.ts";
import { on, onAbort } from "./events.ts";

export interface Size {
  width: number;
  height: number;
}

/** The size of a picture, and how many device pixels each of its pixels has. */
export interface Surface extends Size {
  ratio: number;
}

/** A canvas that stays sharp at any pixel ratio; drawn on in CSS pixels. */
export class Layer {
  readonly canvas: HTMLCanvasElement;
  readonly context: CanvasRenderingContext2D;

  constructor(parent: HTMLElement) {
    const canvas = make("canvas", "rw-layer");
    canvas.ariaHidden = "true";
    const context = canvas.getContext("2d");
    if (!context) throw new Error("robowidgets: no 2D canvas here");
    this.canvas = canvas;
    this.context = context;
    parent.append(canvas);
  }

  /** Clears the layer for a picture of this size. */
  begin({ width, height, ratio }: Surface): CanvasRenderingContext2D {
    const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (this.canvas.width !== w || this.canvas.height !== h) {
      this.canvas.width = w;
      this.canvas.height = h;
      // The box of the element may differ by a fraction of a pixel; a canvas scaled to it would be blurred.
      this.canvas.style.width = `${width}px`;
      this.canvas.style.height = `${height}px`;
    }
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.context.clearRect(0, 0, width, height);
    return this.context;
  }
}

const HALO = 4;

/** Writes text, vertically centred at y; with a halo of some colour, which keeps it apart from lines below it. */
export function write(
  context: CanvasRenderingContext2D,
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

/**
 * Calls back with the size of an element now, and whenever the size or the pixel ratio changes.
 *
 * @returns a function that calls back at once, with a given pixel ratio or the screen's
 */
export function watchSize(
  element: HTMLElement,
  callback: (size: Surface) => void,
  signal: AbortSignal,
): (ratio?: number) => void {
  const tell = (ratio = devicePixelRatio) =>
    callback({ width: element.clientWidth, height: element.clientHeight, ratio });
  const observer = new ResizeObserver(() => tell());
  observer.observe(element);
  onAbort(signal, () => observer.disconnect());
  const watchRatio = () => {
    const query = matchMedia(`(resolution: ${devicePixelRatio}dppx)`);
    const onRatio = () => {
      tell();
      watchRatio();
    };
    on(query, "change", onRatio, signal, { once: true });
  };
  watchRatio();
  return tell;
}
