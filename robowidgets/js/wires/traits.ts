import type { SampleTraits } from "../shared/traits.ts";

export interface WiresTraits extends SampleTraits {
  /** Text that the names on show contain; empty: all. */
  filter: string;
  /** Whether what every node has is shown. */
  infrastructure: boolean;
  /** Namespaces that a person unfolded, with the kind of what is in them: "topics /camera". */
  unfolded: string[];
  /** Whether Python shows the messages of a topic that is asked for. */
  _can_open: boolean;
}
