import { decodeImage, type Picture } from "./image/frame.ts";
import type { ImageTraits } from "./image/traits.ts";
import { ImageView } from "./image/view.ts";
import { Credit } from "./shared/credit.ts";
import type { Initialized, Rendered } from "./shared/model.ts";
import { Stream } from "./shared/stream.ts";

/** Called once per model, so that its views share one stream. */
export default () => {
  let stream: Stream<Picture>;
  let credit: Credit;
  return {
    initialize({ model, signal }: Initialized<ImageTraits>) {
      stream = new Stream(model, decodeImage, signal);
      credit = new Credit(model, signal);
    },
    render({ model, el, signal }: Rendered<ImageTraits>) {
      new ImageView(model, el, stream, credit, signal);
    },
  };
};
