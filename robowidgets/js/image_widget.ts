import { decodeImage } from "./image/frame.ts";
import { ImageView } from "./image/view.ts";
import { Credit } from "./shared/credit.ts";
import { perModel } from "./shared/per_model.ts";
import { Stream } from "./shared/stream.ts";

/** Its views share one stream. */
export default perModel(ImageView, (model, signal) => [
  new Stream(model, decodeImage, signal),
  new Credit(model, signal),
]);
