import { decodeTouch, type Touch } from "./shared/frames/touch.ts";
import type { Initialized, Rendered } from "./shared/model.ts";
import { Stream } from "./shared/stream.ts";
import { Clock } from "./touch/clock.ts";
import type { TouchTraits } from "./touch/traits.ts";
import { TouchView } from "./touch/view.ts";

/** Called once per model, so that its views share one stream and one clock. */
export default () => {
  let stream: Stream<Touch>;
  let clock: Clock;
  return {
    initialize({ model, signal }: Initialized<TouchTraits>) {
      stream = new Stream(model, decodeTouch, signal);
      clock = new Clock(stream, signal);
    },
    render({ model, el, signal }: Rendered<TouchTraits>) {
      new TouchView(model, el, stream, clock, signal);
    },
  };
};
