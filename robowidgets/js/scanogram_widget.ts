import { State } from "./scanogram/state.ts";
import { ScanogramView } from "./scanogram/view.ts";
import type { Model } from "./shared/model.ts";

/** Called once per model, so that its views share what is known. */
export default () => {
  let state: State;
  return {
    initialize({ model, signal }: { model: Model; signal: AbortSignal }) {
      state = new State(model, signal);
    },
    render({ model, el, signal }: { model: Model; el: HTMLElement; signal: AbortSignal }) {
      new ScanogramView(model, el, state, signal);
    },
  };
};
