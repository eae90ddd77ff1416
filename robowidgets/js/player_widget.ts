import { PlayerBar } from "./player/bar.ts";
import type { Moved } from "./player/moved.ts";
import { Playback } from "./player/playback.ts";
import type { PlayerTraits } from "./player/traits.ts";
import type { Initialized, Rendered } from "./shared/model.ts";

/** Called once per model, so that its views share one playback, which also runs without a view of the bar. */
export default () => {
  let playback: Playback;
  return {
    initialize({ model, signal }: Initialized<PlayerTraits>) {
      const find = (ids: string[]): Promise<unknown[]> =>
        Promise.all(ids.map((id) => model.widget_manager.get_model(id)));
      const moved = async () => {
        const [targets, followers] = await Promise.all([find(model.get("_targets")), find(model.get("_followers"))]);
        return { targets, followers } as Moved;
      };
      playback = new Playback(model, moved, signal);
    },
    render({ model, el, signal }: Rendered<PlayerTraits>) {
      new PlayerBar(model, el, playback, signal);
    },
  };
};
