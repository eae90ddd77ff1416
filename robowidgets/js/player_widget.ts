import { PlayerBar } from "./player/bar.ts";
import { type Host, Playback } from "./player/playback.ts";
import type { Model } from "./shared/model.ts";

/** Called once per model, so that its views share one playback, and widgets move without any view of the bar. */
export default () => {
  let playback: Playback;
  return {
    initialize({ model, signal }: { model: Model; signal: AbortSignal }) {
      const hosts = (name: string) =>
        Promise.all(
          (model.get(name) as string[]).map((id) => model.widget_manager.get_model(id)),
        ) as unknown as Promise<Host[]>;
      const moved = Promise.all([hosts("_targets"), hosts("_followers")]).then(([targets, followers]) => ({
        targets,
        followers,
      }));
      playback = new Playback(model, moved, signal);
    },
    render({ model, el, signal }: { model: Model; el: HTMLElement; signal: AbortSignal }) {
      new PlayerBar(model, el, playback, signal);
    },
  };
};
