import { decodeSpeeds } from "./shared/frames/speeds.ts";
import { perModel } from "./shared/per_model.ts";
import { Stream } from "./shared/stream.ts";
import { SpeedView } from "./speed/view.ts";

/** Its views share one stream. */
export default perModel(SpeedView, (model, signal) => [new Stream(model, decodeSpeeds, signal)]);
