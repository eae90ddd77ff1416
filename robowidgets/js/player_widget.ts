import { PlayerBar } from "./player/bar.ts";
import type { Moved } from "./player/moved.ts";
import { Playback } from "./player/playback.ts";
import { perModel } from "./shared/per_model.ts";

/** Its views share one playback, which also runs without a view of the bar. */
export default perModel(PlayerBar, (model, signal) => {
  const find = (ids: string[]): Promise<unknown[]> => Promise.all(ids.map((id) => model.widget_manager.get_model(id)));
  const moved = async () => {
    const [targets, followers] = await Promise.all([find(model.get("_targets")), find(model.get("_followers"))]);
    return { targets, followers } as Moved;
  };
  return [new Playback(model, moved, signal)];
});
