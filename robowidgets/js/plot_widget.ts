import { PlotData } from "./plot/data.ts";
import { PlotMember } from "./plot/member.ts";
import type { PlotTraits } from "./plot/traits.ts";
import { PlotView } from "./plot/view.ts";
import type { Initialized, Rendered } from "./shared/model.ts";
import type { Pointing } from "./shared/traits.ts";

/** Called once per model, so that its views share the decoded lines. */
export default () => {
  let data: PlotData;
  let member: PlotMember;
  return {
    initialize({ model, signal }: Initialized<PlotTraits>) {
      data = new PlotData(model, signal);
      member = new PlotMember(model, data, signal);
    },
    render({ model, el, signal }: Rendered<PlotTraits & Pointing>) {
      new PlotView(model, el, data, member, signal);
    },
  };
};
