import { decodeWhole, type Whole } from "./scanogram/data.ts";
import { State } from "./scanogram/state.ts";
import { ScanogramView } from "./scanogram/view.ts";
import type { Model } from "./shared/model.ts";
import { Stream } from "./shared/stream.ts";

/** Called once per model, so that its views share what is known. */
export default () => {
  let stream: Stream<Whole>;
  let state: State;
  return {
    initialize({ model, signal }: { model: Model; signal: AbortSignal }) {
      stream = new Stream(model, decodeWhole, signal);
      state = new State(model, stream, signal);
    },
    render({ model, el, signal }: { model: Model; el: HTMLElement; signal: AbortSignal }) {
      new ScanogramView(model, el, stream, state, signal);
    },
  };
};
