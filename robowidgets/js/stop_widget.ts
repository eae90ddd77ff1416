import type { StopTraits } from "./shared/driving/traits.ts";
import type { Rendered } from "./shared/model.ts";
import { StopView } from "./stop/view.ts";

export default {
  render({ model, el, signal }: Rendered<StopTraits>) {
    new StopView(model, el, signal);
  },
};
