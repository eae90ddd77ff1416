import { perModel } from "./shared/per_model.ts";
import { Stream } from "./shared/stream.ts";
import { WiresView } from "./wires/view.ts";
import { decodeWiring } from "./wires/wiring.ts";

/** Its views share one stream. */
export default perModel(WiresView, (model, signal) => [new Stream(model, decodeWiring, signal)]);
