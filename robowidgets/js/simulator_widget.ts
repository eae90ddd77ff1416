import type { Rendered } from "./shared/model.ts";
import type { SimulatorTraits } from "./simulator/traits.ts";
import { SimulatorView } from "./simulator/view.ts";

export default {
  render({ model, el, signal }: Rendered<SimulatorTraits>) {
    new SimulatorView(model, el, signal);
  },
};
