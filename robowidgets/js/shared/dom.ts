import { on } from "./events.ts";

/** An element with a class and text. Text is only ever set as text. */
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

/** Sets text without touching the page when it is the same. */
export function setText(element: HTMLElement, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

/** Says what a button does, to readers of screens and as a tooltip. */
export function setLabel(button: HTMLButtonElement, label: string): void {
  button.title = label;
  button.setAttribute("aria-label", label);
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

/** The box of an element in the coordinates of one that holds it. */
export function boxWithin(parent: HTMLElement, element: HTMLElement) {
  const [outer, inner] = [parent.getBoundingClientRect(), element.getBoundingClientRect()];
  return { x: inner.left - outer.left, y: inner.top - outer.top, width: inner.width, height: inner.height };
}

const SVG = "http://www.w3.org/2000/svg";

/** A 12 by 12 icon from path data. */
export function makeIcon(path: string): SVGSVGElement {
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", "0 0 12 12");
  svg.setAttribute("aria-hidden", "true");
  svg.classList.add("rw-icon");
  const shape = document.createElementNS(SVG, "path");
  shape.setAttribute("d", path);
  svg.append(shape);
  return svg;
}
