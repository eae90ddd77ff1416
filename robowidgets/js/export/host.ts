import { make } from "../shared/dom.ts";
import type { Host } from "../shared/model.ts";
import type { PageModel } from "./model.ts";

/** A widget's script, as anywidget calls it. */
export interface Script {
  initialize?(given: { model: PageModel; signal: AbortSignal }): unknown;
  render(given: { model: PageModel; el: HTMLElement; host: Host; signal: AbortSignal }): unknown;
}

/** A page never closes its widgets. */
export const FOREVER: AbortSignal = new AbortController().signal;

const PREFIX = "anywidget:";

/** Initializes the widgets of a page without a kernel, and shows one of them in a new element. */
export async function showWidget(
  id: string,
  models: Map<string, PageModel>,
  scripts: Map<string, Script>,
  place: ParentNode,
  signal: AbortSignal,
): Promise<void> {
  // All models exist before the first is initialized: a player moves the others.
  for (const [one, model] of models) scripts.get(one)?.initialize?.({ model, signal });
  const host: Host = {
    async getWidget(reference) {
      const one = reference.slice(PREFIX.length);
      const [model, script] = [models.get(one), scripts.get(one)];
      if (!model || !script) throw new Error(`${reference} is not in this page`);
      return { render: ({ el, signal }) => script.render({ model, el, host, signal }) };
    },
  };
  const item = make("div", "rw-page-item");
  place.append(item);
  (await host.getWidget(`${PREFIX}${id}`)).render({ el: item, signal });
}
