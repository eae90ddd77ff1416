import type { Look } from "../shared/traits.ts";

/** A topic in the list; unknown values are null. */
export interface TopicRow {
  name: string;
  type: string;
  messages: number | null;
  /** Messages per second. */
  rate: number | null;
  /** Name of the widget that shows it, or "". */
  widget: string;
  /** The reason why no widget shows it, or "". */
  problem: string;
}

export interface TopicsTraits {
  theme: Look;
  /** True if it is folded away; null to decide by the room. The view writes it. */
  folded: boolean | null;
  /** True if the wires of all topics are on show below. */
  wires: boolean;
  _rows: TopicRow[];
  /** Names of the topics on show, with the titles of their widgets. */
  _shown: Record<string, string[]>;
  /** True if topics cannot be shown or removed: in a page without a kernel. */
  _fixed: boolean;
  /** The reason why a topic could not be shown, or "". */
  _error: string;
}
