import type { Model } from "../shared/model.ts";
import type { Picking, Pointing, Recent, SampleTraits, TimeTraits } from "../shared/traits.ts";

/** A widget's model in its host. `set_state` acts like a message of the kernel: nothing is sent to the kernel. */
export interface Host<T> extends Pick<Model<T>, "get" | "set" | "save_changes" | "on" | "off"> {
  set_state(state: Partial<T>): void;
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
