import { decodeSpeeds, type Speeds } from "./shared/frames/speeds.ts";
import type { Initialized, Rendered } from "./shared/model.ts";
import { Stream } from "./shared/stream.ts";
import type { SpeedTraits } from "./speed/traits.ts";
import { SpeedView } from "./speed/view.ts";

/** Called once per model, so that its views share one stream. */
export default () => {
  let stream: Stream<Speeds>;
  return {
    initialize({ model, signal }: Initialized<SpeedTraits>) {
      stream = new Stream(model, decodeSpeeds, signal);
    },
    render({ model, el, signal }: Rendered<SpeedTraits>) {
      new SpeedView(model, el, stream, signal);
    },
  };
};
