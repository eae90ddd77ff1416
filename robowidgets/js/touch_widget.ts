import { decodeTouch } from "./shared/frames/touch.ts";
import { perModel } from "./shared/per_model.ts";
import { Stream } from "./shared/stream.ts";
import { Clock } from "./touch/clock.ts";
import { TouchView } from "./touch/view.ts";

/** Its views share one stream and one clock. */
export default perModel(TouchView, (model, signal) => {
  const stream = new Stream(model, decodeTouch, signal);
  return [stream, new Clock(stream, signal)];
});
