import type { Initialized, Rendered } from "./shared/model.ts";
import { Stream } from "./shared/stream.ts";
import type { WiresTraits } from "./wires/traits.ts";
import { WiresView } from "./wires/view.ts";
import { decodeWiring, type WiringFrame } from "./wires/wiring.ts";

/** Called once per model, so that its views share one stream. */
export default () => {
  let stream: Stream<WiringFrame>;
  return {
    initialize({ model, signal }: Initialized<WiresTraits>) {
      stream = new Stream(model, decodeWiring, signal);
    },
    render({ model, el, signal }: Rendered<WiresTraits>) {
      new WiresView(model, el, stream, signal);
    },
  };
};
