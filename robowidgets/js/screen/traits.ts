/** The places of a screen; robowidgets/screens/layout.py chooses one for each widget. */
export type Place = "bar" | "topics" | "mains" | "smalls" | "wides" | "below" | "wide" | "narrow" | "map" | "foot";

/** A widget on the screen. */
export interface Room {
  place: Place;
  /** The reference to its model that anywidget's host takes. */
  widget: string;
  classes: string[];
  /** By the names of CSS. */
  style: Record<string, string>;
}

export interface ScreenTraits {
  _children: Room[];
  /** Lines of plain text: above the bar of a recording, below the bar of a feed. */
  _notes: string[];
  /** "recording", "feed" or "", and more words, which become classes. */
  _kind: string;
}
