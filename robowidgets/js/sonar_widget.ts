import { decodeRing } from "./shared/frames/ring.ts";
import { perModel } from "./shared/per_model.ts";
import { Stream } from "./shared/stream.ts";
import { SonarView } from "./sonar/view.ts";

/** Its views share one stream. */
export default perModel(SonarView, (model, signal) => [new Stream(model, decodeRing, signal)]);
