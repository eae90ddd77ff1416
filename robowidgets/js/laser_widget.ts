import { LaserView } from "./laser/view.ts";
import { decodeScan } from "./shared/frames/scan.ts";
import { setTraits } from "./shared/model.ts";
import { perModel } from "./shared/per_model.ts";
import { Stream } from "./shared/stream.ts";

/** Its views share one stream. */
export default perModel(LaserView, (model, signal) => {
  // The page was left, or the notebook saved, with the pointer on the picture: discard that.
  if (model.get("hovered") !== null) setTraits(model, { hovered: null });
  return [new Stream(model, decodeScan, signal)];
});
