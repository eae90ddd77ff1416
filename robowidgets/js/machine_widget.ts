import { Outlines } from "./machine/outlines.ts";
import { decodeStep, type Step } from "./machine/step.ts";
import type { MachineTraits } from "./machine/traits.ts";
import { MachineView } from "./machine/view.ts";
import type { Initialized, Rendered } from "./shared/model.ts";
import { Stream } from "./shared/stream.ts";

/** Called once per model, so that its views share one stream and the outlines of earlier versions. */
export default () => {
  let stream: Stream<Step>;
  let outlines: Outlines;
  return {
    initialize({ model, signal }: Initialized<MachineTraits>) {
      stream = new Stream(model, decodeStep, signal);
      outlines = new Outlines(model, signal);
    },
    render({ model, el, signal }: Rendered<MachineTraits>) {
      new MachineView(model, el, stream, outlines, signal);
    },
  };
};
