import type { Model } from "./shared/model.ts";
import { StopView } from "./stop/view.ts";

export default {
  render({ model, el, signal }: { model: Model; el: HTMLElement; signal: AbortSignal }) {
    new StopView(model, el, signal);
  },
};
