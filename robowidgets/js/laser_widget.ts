import { decodeScan } from "./laser/scan.ts";
import { LaserView } from "./laser/view.ts";
import type { Model } from "./shared/model.ts";
import { Stream } from "./shared/stream.ts";

/** Called once per model, so that its views share one stream. */
export default () => {
  let stream: Stream<ReturnType<typeof decodeScan>>;
  return {
    initialize({ model, signal }: { model: Model; signal: AbortSignal }) {
      stream = new Stream(model, decodeScan, signal);
    },
    render({ model, el, signal }: { model: Model; el: HTMLElement; signal: AbortSignal }) {
      new LaserView(model, el, stream, signal);
    },
  };
};
