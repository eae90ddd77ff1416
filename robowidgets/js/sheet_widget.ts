import { perModel } from "./shared/per_model.ts";
import { Pictures } from "./sheet/pictures.ts";
import { SheetView } from "./sheet/view.ts";

/** Its views share the pictures. */
export default perModel(SheetView, (model, signal) => [new Pictures(model, signal)]);
