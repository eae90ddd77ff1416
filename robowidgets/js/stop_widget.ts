import type { Rendered } from "./shared/model.ts";
import type { StopTraits } from "./stop/traits.ts";
import { StopView } from "./stop/view.ts";

export default {
  render({ model, el, signal }: Rendered<StopTraits>) {
    new StopView(model, el, signal);
  },
};
