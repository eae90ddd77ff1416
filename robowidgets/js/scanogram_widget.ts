import { State } from "./scanogram/state.ts";
import type { ScanogramTraits } from "./scanogram/traits.ts";
import { ScanogramView } from "./scanogram/view.ts";
import type { Initialized, Rendered } from "./shared/model.ts";
import type { Pointing } from "./shared/traits.ts";

/** Called once per model, so that its views share the decoded scans. */
export default () => {
  let state: State;
  return {
    initialize({ model, signal }: Initialized<ScanogramTraits & Pointing>) {
      state = new State(model, signal);
    },
    render({ model, el, signal }: Rendered<ScanogramTraits>) {
      new ScanogramView(model, el, state, signal);
    },
  };
};
