import type { Rendered } from "./shared/model.ts";
import type { TopicsTraits } from "./topics/traits.ts";
import { TopicsView } from "./topics/view.ts";

export default {
  render({ model, el, signal }: Rendered<TopicsTraits>) {
    new TopicsView(model, el, signal);
  },
};
