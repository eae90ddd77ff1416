import { PlotData } from "./plot/data.ts";
import { PlotMember } from "./plot/member.ts";
import { PlotView } from "./plot/view.ts";
import { perModel } from "./shared/per_model.ts";

/** Its views share the decoded lines. */
export default perModel(PlotView, (model, signal) => {
  const data = new PlotData(model, signal);
  return [data, new PlotMember(model, data, signal)];
});
