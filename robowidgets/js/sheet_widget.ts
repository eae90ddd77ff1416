import type { Initialized, Rendered } from "./shared/model.ts";
import { Pictures } from "./sheet/pictures.ts";
import type { SheetTraits } from "./sheet/traits.ts";
import { SheetView } from "./sheet/view.ts";

/** Called once per model, so that its views share the pictures. */
export default () => {
  let pictures: Pictures;
  return {
    initialize({ model, signal }: Initialized<SheetTraits>) {
      pictures = new Pictures(model, signal);
    },
    render({ model, el, signal }: Rendered<SheetTraits>) {
      new SheetView(model, el, pictures, signal);
    },
  };
};
