import { decodeMessage, type Packed } from "./message/frame.ts";
import type { MessageTraits } from "./message/traits.ts";
import { MessageView } from "./message/view.ts";
import type { Initialized, Rendered } from "./shared/model.ts";
import { Stream } from "./shared/stream.ts";

/** Called once per model, so that its views share one stream. */
export default () => {
  let stream: Stream<Packed>;
  return {
    initialize({ model, signal }: Initialized<MessageTraits>) {
      stream = new Stream(model, decodeMessage, signal);
    },
    render({ model, el, signal }: Rendered<MessageTraits>) {
      new MessageView(model, el, stream, signal);
    },
  };
};
