import { decodeCloud } from "./cloud/cloud.ts";
import { CloudView } from "./cloud/view.ts";
import { Credit } from "./shared/credit.ts";
import { perModel } from "./shared/per_model.ts";
import { Stream } from "./shared/stream.ts";

/** Its views share one stream. */
export default perModel(CloudView, (model, signal) => [
  new Stream(model, decodeCloud, signal),
  new Credit(model, signal),
]);
