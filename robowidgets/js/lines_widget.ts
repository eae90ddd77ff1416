import { Codes } from "./lines/codes.ts";
import { decodeSteps } from "./lines/steps.ts";
import { LinesView } from "./lines/view.ts";
import { perModel } from "./shared/per_model.ts";
import { Stream } from "./shared/stream.ts";

/** Its views share one stream and the sources of earlier versions. */
export default perModel(LinesView, (model, signal) => [
  new Stream(model, decodeSteps, signal),
  new Codes(model, signal),
]);
