import { Ground } from "./path/ground.ts";
import { decodePose } from "./path/path.ts";
import { PathView } from "./path/view.ts";
import { perModel } from "./shared/per_model.ts";
import { Stream } from "./shared/stream.ts";

/** Its views share one stream and its grids. */
export default perModel(PathView, (model, signal) => [new Stream(model, decodePose, signal), new Ground()]);
