import type { SampleTraits } from "../shared/traits.ts";

export interface WiresTraits extends SampleTraits {
  /** Text that the names on show contain, or "" for all. */
  filter: string;
  /** True if topics and services that every node has are shown. */
  infrastructure: boolean;
  /** Namespaces that the user unfolded, with the kind of their contents: "topics /camera". */
  unfolded: string[];
  /** True if Python shows the messages of a topic on request. */
  _can_open: boolean;
}
