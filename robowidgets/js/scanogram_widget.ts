import { State } from "./scanogram/state.ts";
import { ScanogramView } from "./scanogram/view.ts";
import { perModel } from "./shared/per_model.ts";

/** Its views share the decoded scans. */
export default perModel(ScanogramView, (model, signal) => [new State(model, signal)]);
