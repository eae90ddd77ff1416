import type { Model } from "./shared/model.ts";
import { Stream } from "./shared/stream.ts";
import { decodeSpeeds, type Speeds } from "./speed/frame.ts";
import { SpeedView } from "./speed/view.ts";

/** Called once per model, so that its views share one stream. */
export default () => {
  let stream: Stream<Speeds>;
  return {
    initialize({ model, signal }: { model: Model; signal: AbortSignal }) {
      stream = new Stream(model, decodeSpeeds, signal);
    },
    render({ model, el, signal }: { model: Model; el: HTMLElement; signal: AbortSignal }) {
      new SpeedView(model, el, stream, signal);
    },
  };
};
