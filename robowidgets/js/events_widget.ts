import { decodeMoment, type EventsFrame } from "./events/rows.ts";
import type { EventsTraits } from "./events/traits.ts";
import { EventsView } from "./events/view.ts";
import type { Initialized, Rendered } from "./shared/model.ts";
import { Stream } from "./shared/stream.ts";
import type { Pointing } from "./shared/traits.ts";

/** Called once per model, so that its views share one stream. */
export default () => {
  let stream: Stream<EventsFrame>;
  return {
    initialize({ model, signal }: Initialized<EventsTraits>) {
      stream = new Stream(model, decodeMoment, signal);
    },
    render({ model, el, signal }: Rendered<EventsTraits & Pointing>) {
      new EventsView(model, el, stream, signal);
    },
  };
};
