import { PlayerBar } from "./player/bar.ts";
import { type Host, Playback } from "./player/playback.ts";
import type { Model } from "./shared/model.ts";

/** Called once per model, so that its views share one playback, and widgets move without any view of the bar. */
export default () => {
  let playback: Playback;
  return {
    initialize({ model, signal }: { model: Model; signal: AbortSignal }) {
      const ids = (model.get("_targets") as string[]).map((reference) => reference.replace("IPY_MODEL_", ""));
      const targets = Promise.all(ids.map((id) => model.widget_manager.get_model(id)));
      playback = new Playback(model, targets as unknown as Promise<Host[]>, signal);
    },
    render({ model, el, signal }: { model: Model; el: HTMLElement; signal: AbortSignal }) {
      new PlayerBar(model, el, playback, signal);
    },
  };
};
