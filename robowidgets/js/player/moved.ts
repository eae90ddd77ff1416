import type { Model } from "../shared/model.ts";
import type { Picking, Pointing, Recent, SampleTraits, TimeTraits } from "../shared/traits.ts";

/** A widget's model in its host. */
export interface Host<T> extends Pick<Model<T>, "get" | "set" | "save_changes" | "on" | "off"> {
  /** Acts like a message of the kernel: nothing is sent to it. marimo has no such method. */
  set_state?(state: Partial<T>): void;
  /** The state that the kernel sent, while the host applies it. */
  _state_lock?: Record<string, unknown> | null;
}

/** Only a laser has rays that can be pointed at, and shows earlier samples, too. */
export type Target = SampleTraits & Picking & Recent & { hovered?: number | null; trail?: number; spread?: number };
export type Follower = Host<TimeTraits & Pointing>;

/** The models that a player moves. */
export interface Moved {
  /** Of widgets that show frames. */
  targets: Host<Target>[];
  /** Widgets that show the time itself, and let the user choose it. */
  followers: Follower[];
}

/** Sets traits in the page alone, as far as the host can. In marimo they go to the kernel with the next change there. */
export function give<T>(model: Pick<Host<T>, "set" | "set_state">, state: Partial<T>): void {
  if (model.set_state) model.set_state(state);
  else for (const name in state) model.set(name, state[name] as T[typeof name]);
}
