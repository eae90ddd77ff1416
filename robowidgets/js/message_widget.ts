import { decodeMessage } from "./message/frame.ts";
import { MessageView } from "./message/view.ts";
import { perModel } from "./shared/per_model.ts";
import { Stream } from "./shared/stream.ts";

/** Its views share one stream. */
export default perModel(MessageView, (model, signal) => [new Stream(model, decodeMessage, signal)]);
