import { Ground } from "./path/ground.ts";
import { decodePose, type PoseFrame } from "./path/path.ts";
import type { PathTraits } from "./path/traits.ts";
import { PathView } from "./path/view.ts";
import type { Initialized, Rendered } from "./shared/model.ts";
import { Stream } from "./shared/stream.ts";
import type { Picking } from "./shared/traits.ts";

/** Called once per model, so that its views share one stream and its grids. */
export default () => {
  let stream: Stream<PoseFrame>;
  const ground = new Ground();
  return {
    initialize({ model, signal }: Initialized<PathTraits>) {
      stream = new Stream(model, decodePose, signal);
    },
    render({ model, el, signal }: Rendered<PathTraits & Picking>) {
      new PathView(model, el, stream, ground, signal);
    },
  };
};
