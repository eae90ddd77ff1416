import { DriveView } from "./drive/view.ts";
import type { Model } from "./shared/model.ts";

export default {
  render({ model, el, signal }: { model: Model; el: HTMLElement; signal: AbortSignal }) {
    new DriveView(model, el, signal);
  },
};
