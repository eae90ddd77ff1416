import type { LaserTraits } from "./laser/traits.ts";
import { LaserView } from "./laser/view.ts";
import { decodeScan } from "./shared/frames/scan.ts";
import { type Initialized, type Rendered, setTraits } from "./shared/model.ts";
import { Stream } from "./shared/stream.ts";

/** Called once per model, so that its views share one stream. */
export default () => {
  let stream: Stream<ReturnType<typeof decodeScan>>;
  return {
    initialize({ model, signal }: Initialized<LaserTraits>) {
      stream = new Stream(model, decodeScan, signal);
      // The page was left, or the notebook saved, with the pointer on the picture: discard that.
      if (model.get("hovered") !== null) setTraits(model, { hovered: null });
    },
    render({ model, el, signal }: Rendered<LaserTraits>) {
      new LaserView(model, el, stream, signal);
    },
  };
};
