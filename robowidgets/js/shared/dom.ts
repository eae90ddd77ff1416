import type { Box, Point } from "./box.ts";
import { on, onAbort } from "./events.ts";
import { enter } from "./room.ts";

/** An element with a class and text. Text is never parsed as HTML. */
export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  className: string,
  text = "",
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  element.className = className;
  if (text) element.textContent = text;
  return element;
}

/** Sets text; does not touch the page if it is the same. */
export function setText(element: HTMLElement, text: string): void {
  if (element.textContent === text) return;
  const { firstChild } = element;
  // Another node would make the browser check rules with `:has()`, such as those of JupyterLab, up to the root.
  if (text && firstChild instanceof Text && !firstChild.nextSibling) firstChild.data = text;
  else element.textContent = text;
}

/** Most characters of the second part of a name. Shorter names have one part, which can be selected and copied whole. */
const NAME_END = 10;

/** Sets a name that loses its middle without room for it: similar names differ at their ends. A short one loses its end. */
export function setName(element: HTMLElement, name: string): void {
  if (element.textContent === name) return;
  element.classList.add("rw-name");
  const start = name.length - (name.length <= NAME_END ? 0 : Math.min(name.length >> 1, NAME_END));
  const end = start < name.length ? [make("span", "rw-name-end", name.slice(start))] : [];
  element.replaceChildren(make("span", "rw-name-start", name.slice(0, start)), ...end);
}

/**
 * Sets a property that becomes an attribute; does not touch the page if it is the same: setting it would have styles
 * computed again.
 */
export function set<T, K extends keyof T>(holder: T, name: K, value: T[K]): void {
  if (holder[name] !== value) holder[name] = value;
}

/** Hides or shows an element. */
export function setHidden(element: HTMLElement, isHidden: boolean): void {
  set(element, "hidden", isHidden);
}

/** Sets the text that a pointer resting on an element shows. */
export function setTip(element: HTMLElement, tip: string): void {
  set(element, "title", tip);
}

/** Sets the label of a button, for screen readers and as its tooltip. */
export function setLabel(button: HTMLButtonElement, label: string): void {
  setTip(button, label);
  set(button, "ariaLabel", label);
}

/** A button that calls back. */
export function makeButton(
  className: string,
  label: string,
  onClick: () => void,
  signal: AbortSignal,
  text = "",
): HTMLButtonElement {
  const button = make("button", `rw-button ${className}`, text);
  button.type = "button";
  setLabel(button, label);
  on(button, "click", onClick, signal);
  return button;
}

/** Shows a card in a view's own element until the signal aborts: hosts keep the latter, empty, while the model lives. */
export function mount(parent: HTMLElement, card: HTMLElement, signal: AbortSignal): void {
  parent.append(card);
  onAbort(signal, () => card.remove());
  enter(parent, card, signal);
}

/** Pixels of the window per pixel of an element: more than 1 for a projector. Older browsers do not enlarge it. */
export function zoomOf(element: HTMLElement): number {
  return element.currentCSSZoom ?? 1;
}

/** The box of an element in the coordinates of an ancestor. */
export function boxWithin(parent: HTMLElement, element: HTMLElement) {
  const [outer, inner, zoom] = [parent.getBoundingClientRect(), element.getBoundingClientRect(), zoomOf(parent)];
  return {
    x: (inner.left - outer.left) / zoom,
    y: (inner.top - outer.top) / zoom,
    width: inner.width / zoom,
    height: inner.height / zoom,
  };
}

/** The place of a pointer or a finger in the coordinates of an element. */
export function pointIn(element: HTMLElement, { clientX, clientY }: Pick<MouseEvent, "clientX" | "clientY">): Point {
  const [{ left, top }, zoom] = [element.getBoundingClientRect(), zoomOf(element)];
  return { x: (clientX - left) / zoom, y: (clientY - top) / zoom };
}

/** Pixels; a press that moves less is a click. */
const CLICK_SLOP = 4;

/** Returns true if a pointer that was pressed at a place has moved so far that it drags. */
export function isDragged(from: Point, to: Point): boolean {
  return Math.hypot(to.x - from.x, to.y - from.y) >= CLICK_SLOP;
}

/** An element of SVG. */
export function makeSvg(tag: string, attributes: Record<string, string | number> = {}): SVGElement {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  return element;
}

/** Gives an element a box in its parent, in pixels. */
export function setBox<E extends HTMLElement>(element: E, { x, y, width, height }: Box): E {
  Object.assign(element.style, { left: `${x}px`, top: `${y}px`, width: `${width}px`, height: `${height}px` });
  return element;
}

/** A 12 by 12 icon from path data, in the colour of the text. */
export function makeIcon(path: string): HTMLElement {
  const icon = make("span", "rw-icon");
  icon.style.clipPath = `path("${path}")`;
  return icon;
}

/** Paths of icons. */
export const PLAY = "M3 1.2l7 4.8-7 4.8z";
export const PAUSE = "M2.5 1.5h2.5v9h-2.5z M7 1.5h2.5v9h-2.5z";
export const RESET = "M6 1.5a4.5 4.5 0 1 0 4.5 4.5h-1.4a3.1 3.1 0 1 1-3.1-3.1v1.7l3-2.4-3-2.4z";
