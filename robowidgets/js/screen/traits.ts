import type { Look } from "../shared/traits.ts";
import type { StoredPart } from "./tree.ts";

/** The places of a screen; robowidgets/screens/layout.py chooses one for each widget. */
export type Place = "bar" | "topics" | "mains" | "smalls" | "wides" | "below" | "wide" | "narrow" | "map" | "foot";

/** A widget on the screen. */
export interface Room {
  place: Place;
  /** The reference to its model that anywidget's host takes. */
  widget: string;
  /** Its name in an arrangement by hand. */
  card: string;
  /** The name of its script without "_widget", such as "laser". */
  kind: string;
  classes: string[];
  /** By the names of CSS. */
  style: Record<string, string>;
}

/** An arrangement by hand. */
export interface Cards {
  /** The part that fills the screen; absent if the places of the widgets decide. */
  all?: StoredPart;
}

/** A topic or a field, or fields that share a plot. */
export type Entry = string | string[];

export interface ScreenTraits {
  theme: Look;
  _children: Room[];
  /** Lines of plain text: above the bar of a recording, below the bar of a feed. */
  _notes: string[];
  /** "recording", "feed" or "", and more words, which become classes. */
  _kind: string;
  _cards: Cards;
  /** The shown topics and fields, for the code of an arrangement. */
  _entries: Entry[];
}
