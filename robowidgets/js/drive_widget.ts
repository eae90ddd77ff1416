import type { DriveTraits } from "./drive/traits.ts";
import { DriveView } from "./drive/view.ts";
import type { Rendered } from "./shared/model.ts";

export default {
  render({ model, el, signal }: Rendered<DriveTraits>) {
    new DriveView(model, el, signal);
  },
};
