/**
 * A page in Node without layout: its elements have fixed sizes, its fonts fixed widths, and its clock is moved by hand.
 * Widgets draw into it, and it is written down as text.
 */

import { drawn, letterWidth, RecordedPath, record, round } from "./recorder.ts";

const FILE = new URL("../../../robowidgets/js/node_modules/happy-dom/lib/index.js", import.meta.url).href;
const { Window } = (await import(FILE)) as typeof import("../../../robowidgets/js/node_modules/happy-dom/lib/index.js");

const LINE = 18;
const FRAME_MS = 16;

interface Timer {
  at: number;
  call: () => void;
  every: number;
}

/** Time that passes only in `pass`. */
class Clock {
  now = 1000;
  readonly #timers = new Map<number, Timer>();
  #next = 1;

  add(call: () => void, wait = 0, every = 0): number {
    this.#timers.set(this.#next, { at: this.now + Math.max(wait, 1), call, every });
    return this.#next++;
  }

  drop(id: number | undefined): void {
    this.#timers.delete(id ?? 0);
  }

  clear(): void {
    this.#timers.clear();
  }

  /** Lets time pass, with what waits for promises in between. */
  async pass(ms: number): Promise<void> {
    const end = this.now + ms;
    for (;;) {
      await new Promise(setImmediate);
      const [due] = [...this.#timers].filter(([, { at }]) => at <= end).sort(([, a], [, b]) => a.at - b.at);
      if (!due) break;
      const [id, timer] = due;
      this.now = Math.max(this.now, timer.at);
      if (timer.every) timer.at += timer.every;
      else this.#timers.delete(id);
      timer.call();
    }
    this.now = end;
  }
}

export const clock = new Clock();

/** The size of the picture that is drawn, in pixels. */
export const picture = { width: 0, height: 0 };

type Box = { width: number; height: number };

const window = new Window({ url: "http://localhost/", width: 1200, height: 900 });
export const document = window.document as unknown as Document;

/** The size of an element: pictures and cards have the size of the state, others the size of their text in one line. */
function sizeOf(element: HTMLElement): Box {
  if (element instanceof HTMLCanvasElement) return { width: element.width, height: element.height };
  const [width, height] = [element.style?.width, element.style?.height].map((text) => Number.parseFloat(text ?? ""));
  if (width && height) return { width, height };
  if (element.matches?.("body, html, .rw-card, #view"))
    return { width: picture.width + 2, height: picture.height + 80 };
  if (element.matches?.(".rw-picture, [data-sized]") || element.firstElementChild instanceof HTMLCanvasElement)
    return picture;
  const text = element.textContent ?? "";
  return { width: text ? Math.round(text.length * letterWidth("11px")) : 0, height: text ? LINE : 0 };
}

class Sizes {
  readonly #callback: (entries: unknown[]) => void;

  constructor(callback: (entries: unknown[]) => void) {
    this.#callback = callback;
  }

  observe(target: HTMLElement): void {
    clock.add(() => {
      const { width, height } = sizeOf(target);
      const box = [{ inlineSize: width, blockSize: height }];
      const contentRect = { x: 0, y: 0, left: 0, top: 0, right: width, bottom: height, width, height };
      this.#callback([{ target, contentRect, borderBoxSize: box, contentBoxSize: box, isIntersecting: true }]);
    });
  }

  unobserve(): void {}
  disconnect(): void {}
}

class Nothing {
  observe(): void {}
  disconnect(): void {}
  takeRecords(): [] {
    return [];
  }
}

class Query extends EventTarget {
  readonly matches = false;
}

class Pixels {
  readonly data: Uint8ClampedArray;
  readonly width: number;
  readonly height: number;

  constructor(first: Uint8ClampedArray | number, width: number, height = 0) {
    const isSize = typeof first === "number";
    this.width = isSize ? first : width;
    this.height = isSize ? width : height || first.length / 4 / width;
    this.data = isSize ? new Uint8ClampedArray(4 * first * width) : first;
  }
}

/** happy-dom has no constructor of options. */
function makeOption(text: string, value = text): HTMLOptionElement {
  const option = document.createElement("option");
  option.textContent = text;
  option.value = value;
  return option;
}

const given = window as unknown as Record<string, unknown>;
const names = Object.getOwnPropertyNames(window).filter((name) =>
  /^(HTML|SVG|CSS)?[A-Z]\w*(Element|Event|Node|Text|Fragment)$/.test(name),
);
const more = [
  "Node",
  "Text",
  "Element",
  "ShadowRoot",
  "CSS",
  "DOMParser",
  "XMLSerializer",
  "getComputedStyle",
  "KeyboardEvent",
];
const taken = Object.fromEntries(
  [...names, ...more].filter((name) => name in given).map((name) => [name, given[name]]),
);
delete taken.Event;
delete taken.EventTarget;

for (const [name, value] of Object.entries({
  ...taken,
  window,
  document,
  Option: makeOption,
  devicePixelRatio: 1,
  innerWidth: 1200,
  innerHeight: 900,
  getComputedStyle: window.getComputedStyle.bind(window),
  matchMedia: () => new Query(),
  ResizeObserver: Sizes,
  IntersectionObserver: Sizes,
  MutationObserver: Nothing,
  ImageData: Pixels,
  Path2D: RecordedPath,
  requestAnimationFrame: (call: (now: number) => void) => clock.add(() => call(clock.now), FRAME_MS),
  cancelAnimationFrame: (id: number) => clock.drop(id),
  setTimeout: (call: () => void, wait = 0) => clock.add(call, wait),
  setInterval: (call: () => void, wait = 0) => clock.add(call, wait, Math.max(wait, 1)),
  clearTimeout: (id: number) => clock.drop(id),
  clearInterval: (id: number) => clock.drop(id),
  reportError: (error: unknown) => {
    throw error;
  },
})) {
  Object.defineProperty(globalThis, name, { value, configurable: true, writable: true });
}
performance.now = () => clock.now;

const elements = window.HTMLElement.prototype as unknown as HTMLElement;
for (const name of ["client", "offset", "scroll"]) {
  for (const side of ["Width", "Height"] as const) {
    Object.defineProperty(elements, `${name}${side}`, {
      configurable: true,
      get(this: HTMLElement) {
        return sizeOf(this)[side === "Width" ? "width" : "height"];
      },
    });
  }
}
const place = (element: HTMLElement) => {
  const { width, height } = sizeOf(element);
  const [left, top] = [element.style?.left, element.style?.top].map((text) => Number.parseFloat(text ?? "") || 0);
  return { x: left, y: top, left, top, width, height, right: (left ?? 0) + width, bottom: (top ?? 0) + height };
};
Object.assign((window.Element as unknown as typeof Element).prototype, {
  getBoundingClientRect(this: HTMLElement) {
    return place(this);
  },
  setPointerCapture() {},
  releasePointerCapture() {},
  hasPointerCapture: () => false,
  scrollIntoView() {},
  scrollTo() {},
  checkVisibility: () => true,
});
/** happy-dom does not reflect these. */
for (const name of ["Label", "Pressed", "Expanded", "Checked", "Selected", "Current", "Disabled", "Hidden", "Live"]) {
  const attribute = `aria-${name.toLowerCase()}`;
  Object.defineProperty((window.Element as unknown as typeof Element).prototype, `aria${name}`, {
    configurable: true,
    get(this: Element) {
      return this.getAttribute(attribute);
    },
    set(this: Element, value: string | null) {
      if (value === null) this.removeAttribute(attribute);
      else this.setAttribute(attribute, value);
    },
  });
}
const contexts = new WeakMap<object, unknown>();
Object.assign((window.HTMLCanvasElement as unknown as typeof HTMLCanvasElement).prototype, {
  getContext(this: HTMLCanvasElement) {
    if (!contexts.has(this)) contexts.set(this, record(this));
    return contexts.get(this);
  },
});

/** Attributes that are written, unrounded; styles only if a script sets them. */
const SAID = ["role", "aria-label", "title", "value", "placeholder"];
const STATES = [
  "aria-pressed",
  "aria-expanded",
  "aria-checked",
  "aria-selected",
  "aria-current",
  "aria-disabled",
  "disabled",
  "checked",
];
const SHAPES = [
  "d",
  "x",
  "y",
  "x1",
  "y1",
  "x2",
  "y2",
  "cx",
  "cy",
  "r",
  "width",
  "height",
  "points",
  "transform",
  "fill",
  "stroke",
];

const roundAll = (text: string, isPixels: boolean) =>
  text.replace(/-?\d+\.\d+(px)?/g, (number, unit = "") =>
    unit || isPixels ? `${round(Number.parseFloat(number))}${unit}` : String(Math.round(Number(number) * 100) / 100),
  );

/** Writes an element down: its words, and what a screen reader says. What shows and says nothing is left out. */
export function describe(element: Element, indent = ""): string[] {
  if (element.hasAttribute("hidden")) return [];
  if (element instanceof HTMLCanvasElement) {
    const lines = drawn(element);
    return lines.length
      ? [`${indent}canvas ${element.width}×${element.height}`, ...lines.map((line) => `${indent}  ${line}`)]
      : [];
  }
  const children = [...element.children].flatMap((child) => describe(child, `${indent}  `));
  const own = [...element.childNodes].filter((node) => node.nodeType === 3).map((node) => node.textContent?.trim());
  const text = own.filter(Boolean).join(" ");
  const isShape = element.namespaceURI?.endsWith("svg") ?? false;
  const attributes = [...SAID, ...STATES, ...(isShape ? SHAPES : [])].flatMap((name) => {
    const value = name === "value" ? (element as HTMLInputElement).value : element.getAttribute(name);
    return value === null || value === undefined || value === ""
      ? []
      : [`${name}=${SHAPES.includes(name) ? roundAll(JSON.stringify(value), true) : JSON.stringify(value)}`];
  });
  const style = isShape
    ? ""
    : roundAll(element.getAttribute("style") ?? "", false)
        .replace(/\s+/g, " ")
        .trim();
  const isPlain = !text && !attributes.length && !style;
  if (isPlain && !children.length) return [];
  const classes = [...element.classList].filter((name) => name.startsWith("rw-")).map((name) => `.${name}`);
  const head = [
    `${indent}${element.localName}${classes.join("")}`,
    text && JSON.stringify(text),
    ...attributes,
    style && `{${style}}`,
  ];
  return [head.filter(Boolean).join(" "), ...children];
}
