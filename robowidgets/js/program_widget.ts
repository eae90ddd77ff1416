import type { ProgramTraits } from "./program/traits.ts";
import { ProgramView } from "./program/view.ts";
import type { Rendered } from "./shared/model.ts";

export default {
  render({ model, el, signal }: Rendered<ProgramTraits>) {
    new ProgramView(model, el, signal);
  },
};
