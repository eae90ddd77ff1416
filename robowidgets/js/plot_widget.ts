import { PlotData } from "./plot/data.ts";
import type { PlotTraits } from "./plot/traits.ts";
import { PlotView } from "./plot/view.ts";
import type { Initialized, Rendered } from "./shared/model.ts";

/** Called once per model, so that its views share the decoded lines. */
export default () => {
  let data: PlotData;
  return {
    initialize({ model, signal }: Initialized<PlotTraits>) {
      data = new PlotData(model, signal);
    },
    render({ model, el, signal }: Rendered<PlotTraits>) {
      new PlotView(model, el, data, signal);
    },
  };
};
