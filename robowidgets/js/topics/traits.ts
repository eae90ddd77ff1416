/** A topic in the list; what is not known is null. */
export interface TopicRow {
  name: string;
  type: string;
  messages: number | null;
  /** Messages per second. */
  rate: number | null;
  /** Name of the widget that shows it; empty without one. */
  widget: string;
  /** Why nothing shows it; else empty. */
  problem: string;
}

export interface TopicsTraits {
  /** Whether it is folded away; null: by the room. The view writes it. */
  folded: boolean | null;
  /** Whether the wires of all topics are on show below the rest. */
  wires: boolean;
  _rows: TopicRow[];
  /** Names of the topics on show, with the titles of their widgets. */
  _shown: Record<string, string[]>;
  /** Whether nothing can be shown or taken off: in a page without a kernel. */
  _fixed: boolean;
  /** Why a topic could not be shown; else empty. */
  _error: string;
}
