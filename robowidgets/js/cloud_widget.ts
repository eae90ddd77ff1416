import { type Cloud, decodeCloud } from "./cloud/cloud.ts";
import type { CloudTraits } from "./cloud/traits.ts";
import { CloudView } from "./cloud/view.ts";
import { Credit } from "./shared/credit.ts";
import type { Initialized, Rendered } from "./shared/model.ts";
import { Stream } from "./shared/stream.ts";

/** Called once per model, so that its views share one stream. */
export default () => {
  let stream: Stream<Cloud>;
  let credit: Credit;
  return {
    initialize({ model, signal }: Initialized<CloudTraits>) {
      stream = new Stream(model, decodeCloud, signal);
      credit = new Credit(model, signal);
    },
    render({ model, el, signal }: Rendered<CloudTraits>) {
      new CloudView(model, el, stream, credit, signal);
    },
  };
};
