import { decodeRing, type Ring } from "./shared/frames/ring.ts";
import type { Initialized, Rendered } from "./shared/model.ts";
import { Stream } from "./shared/stream.ts";
import type { SonarTraits } from "./sonar/traits.ts";
import { SonarView } from "./sonar/view.ts";

/** Called once per model, so that its views share one stream. */
export default () => {
  let stream: Stream<Ring>;
  return {
    initialize({ model, signal }: Initialized<SonarTraits>) {
      stream = new Stream(model, decodeRing, signal);
    },
    render({ model, el, signal }: Rendered<SonarTraits>) {
      new SonarView(model, el, stream, signal);
    },
  };
};
