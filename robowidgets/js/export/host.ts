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

/** The reference by which a host knows a model. */
export function toReference(id: string): string {
  return `${PREFIX}${id}`;
}

/** The host of a page without a kernel, as anywidget hands it to widgets that hold others. */
export function makeHost(models: Map<string, PageModel>, scripts: Map<string, Script>): Host {
  const host: Host = {
    async getWidget(reference) {
      const id = reference.slice(PREFIX.length);
      const [model, script] = [models.get(id), scripts.get(id)];
      if (!model || !script) throw new Error(`${reference} is not in this page`);
      return { render: ({ el, signal }) => script.render({ model, el, host, signal }) };
    },
  };
  return host;
}
