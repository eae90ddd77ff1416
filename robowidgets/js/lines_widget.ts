import { Codes } from "./lines/codes.ts";
import { decodeSteps, type Steps } from "./lines/steps.ts";
import type { LinesTraits } from "./lines/traits.ts";
import { LinesView } from "./lines/view.ts";
import type { Initialized, Rendered } from "./shared/model.ts";
import { Stream } from "./shared/stream.ts";

/** Called once per model, so that its views share one stream and the sources of earlier versions. */
export default () => {
  let stream: Stream<Steps>;
  let codes: Codes;
  return {
    initialize({ model, signal }: Initialized<LinesTraits>) {
      stream = new Stream(model, decodeSteps, signal);
      codes = new Codes(model, signal);
    },
    render({ model, el, signal }: Rendered<LinesTraits>) {
      new LinesView(model, el, stream, codes, signal);
    },
  };
};
