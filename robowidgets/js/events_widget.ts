import { decodeMoment } from "./events/rows.ts";
import { EventsView } from "./events/view.ts";
import { perModel } from "./shared/per_model.ts";
import { Stream } from "./shared/stream.ts";

/** Its views share one stream. */
export default perModel(EventsView, (model, signal) => [new Stream(model, decodeMoment, signal)]);
