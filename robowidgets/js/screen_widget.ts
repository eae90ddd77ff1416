import type { ScreenTraits } from "./screen/traits.ts";
import { ScreenView } from "./screen/view.ts";
import type { Hosted } from "./shared/model.ts";

export default {
  render({ model, el, host, signal }: Hosted<ScreenTraits>) {
    new ScreenView(model, el, host, signal);
  },
};
