import { Outlines } from "./machine/outlines.ts";
import { decodeStep } from "./machine/step.ts";
import { MachineView } from "./machine/view.ts";
import { perModel } from "./shared/per_model.ts";
import { Stream } from "./shared/stream.ts";

/** Its views share one stream and the outlines of earlier versions. */
export default perModel(MachineView, (model, signal) => [
  new Stream(model, decodeStep, signal),
  new Outlines(model, signal),
]);
