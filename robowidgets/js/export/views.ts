import { make } from "../shared/dom.ts";
import type { PageModel } from "./model.ts";

/** An element of the page: a widget, or a box of others. */
export interface Shown {
  model?: string;
  children?: Shown[];
  classes: string[];
  /** By the names of CSS. */
  style: Record<string, string>;
}

/** A widget's script, as anywidget calls it. */
export interface Script {
  initialize?(given: { model: PageModel; signal: AbortSignal }): unknown;
  render(given: { model: PageModel; el: HTMLElement; signal: AbortSignal }): unknown;
}

/** A page never closes its widgets. */
export const FOREVER: AbortSignal = new AbortController().signal;

/** Builds an element with all that it holds. */
export function build(
  shown: Shown,
  models: Map<string, PageModel>,
  scripts: Map<string, Script>,
  signal = FOREVER,
): HTMLElement {
  const element = make("div", "rw-page-item");
  element.classList.add(...shown.classes);
  for (const [name, value] of Object.entries(shown.style)) element.style.setProperty(name, value);
  if (shown.children) {
    element.classList.add("rw-page-box");
    element.append(...shown.children.map((child) => build(child, models, scripts, signal)));
  }
  const model = shown.model === undefined ? undefined : models.get(shown.model);
  if (model && shown.model) scripts.get(shown.model)?.render({ model, el: element, signal });
  return element;
}
