import { copyOf, toBytes } from "../shared/bytes.ts";
import { type Model, onChange } from "../shared/model.ts";
import { firstWhere } from "../shared/search.ts";
import type { Host } from "./moved.ts";
import type { PlayerTraits } from "./traits.ts";

export type PlayerModel = Model<PlayerTraits> & Pick<Host<PlayerTraits>, "_state_lock">;

/**
 * Calls back with the time of the place to which the leader of a player moves; NaN if there is no such place.
 *
 * @param goTo also gets true if the kernel sent the move: then another page made it, and moves the follower, too
 */
export function followLeader(
  model: Model<PlayerTraits>,
  goTo: (time: number, isSent: boolean) => void,
  signal: AbortSignal,
): void {
  let leader = model.get("_leader");
  const follow = async (isAtPlace: boolean) => {
    const own = model.get("_leader");
    leader = own;
    if (!own.model) return;
    // A player that was closed leads nowhere.
    const other = (await model.widget_manager.get_model(own.model).catch(() => null)) as PlayerModel | null;
    if (!other || signal.aborted) return;
    const [times, seconds] = [toFloats(own.times), toFloats(own.seconds)];
    const toPlace = (shown: number) => seconds[firstWhere(times, (time) => time > shown) - 1] ?? NaN;
    let before: number | null = null;
    const onMove = () => {
      const shown = other.get("_shown");
      if (leader !== own || shown === null || shown === before) return;
      before = shown;
      goTo(toPlace(shown), Boolean(other._state_lock));
    };
    if (isAtPlace) {
      // The page was reloaded: the follower stays at its present time until the leader moves.
      before = other.get("_shown") ?? other.get("time");
      if (Number.isNaN(toPlace(before))) goTo(NaN, false);
    }
    onChange(other, ["_shown"], onMove, signal);
    onMove();
  };
  onChange(model, ["_leader"], () => follow(false), signal);
  follow(true);
}

function toFloats(view: DataView | undefined): Float64Array {
  const bytes = toBytes(view);
  return new Float64Array(bytes ? copyOf(bytes, 0, bytes.byteLength) : []);
}
