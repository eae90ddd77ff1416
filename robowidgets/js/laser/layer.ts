import { type Box, isWithin, overlaps, type Point } from "../shared/box.ts";
import type { Surface } from "../shared/canvas.ts";
import type { Limits, Scan, Sweep } from "../shared/frames/scan.ts";
import type { Model } from "../shared/model.ts";
import type { Occupancy } from "../shared/occupancy.ts";
import type { Projection, Rim } from "../shared/projection.ts";
import type { SampleCard } from "../shared/sample_card.ts";
import type { Stream } from "../shared/stream.ts";
import type { Theme } from "../shared/theme.ts";
import type { LaserTraits } from "./traits.ts";

/** Depths of the lower canvas, from the ground up. It is painted again only when something in it changes. */
export const LOWER = ["area", "free", "fills", "guides"] as const;

/** Depths of the upper canvas, above the depths of the lower one. It is painted with each scan. */
export const UPPER = [
  "ghost",
  "edges",
  "conditions",
  "readings",
  "shapes",
  "rings",
  "robot",
  "names",
  "words",
  "pointer",
  "handles",
] as const;

export type Depth = (typeof LOWER)[number] | (typeof UPPER)[number];

/** The data that all layers share: the geometry of the picture, and the parts that are taken. */
export interface Stage {
  /** The scan to draw; null before the first. */
  scan: Scan | null;
  /** Of the scan, or of a common scanner before the first. */
  sweep: Sweep & Limits;
  projection: Projection;
  size: Surface;
  /** The part of the picture that is free for drawing. */
  box: Box;
  /** Parts of the picture that readings cover. A layer adds its parts that labels must not cover. */
  occupied: Occupancy;
  /** Boxes of labels. A layer adds its boxes. */
  labels: Box[];
  /** Boxes of elements that stand over the picture. A layer adds its boxes. */
  covered: Box[];
  /** Angles of lines from the scanner to the rim that stand out. A layer adds its lines. */
  edges: number[];
}

/**
 * Returns true if a label may stand at a place: within the picture, and not on a reading, another label or an element.
 */
export function isFree({ box, occupied, labels, covered }: Stage, place: Box): boolean {
  const isTaken = [...labels, ...covered].some((other) => overlaps(place, other, 1));
  return isWithin(place, box) && !isTaken && !occupied.count(place);
}

export type Painter = (context: CanvasRenderingContext2D, stage: Stage, theme: Theme) => void;

/** The index view, in which layers paint too: rays from left to right, metres from the bottom up. */
export interface StripStage {
  scan: Scan | null;
  /** The plot. Above it is room for rays without a distance, and for names. */
  box: Box;
  count: number;
  viewRange: number;
  size: Surface;
  /** The middle of a ray; of half an index, the edge between two. */
  xOf(index: number): number;
  yOf(metres: number): number;
}

export type StripPainter = (context: CanvasRenderingContext2D, strip: StripStage, theme: Theme) => void;

/** The interface of a view for its layers. */
export interface Host {
  readonly model: Model<LaserTraits>;
  readonly stream: Stream<Scan>;
  readonly card: SampleCard;
  readonly signal: AbortSignal;
  /** As it was drawn last. */
  readonly stage: Stage;
}

/** A pressed pointer that is moved. One of `end` and `cancel` is called last. */
export interface Drag {
  move(point: Point): void;
  end(): void;
  /** Restores the state before the drag. */
  cancel(): void;
}

/** Things of a layer that Tab picks one after the other. */
export interface Stops {
  readonly names: string[];
  /** The picked one, or "". */
  readonly picked: string;
  /** Picks one, or none if the name is "". */
  pick(name: string): void;
}

/**
 * A part of the picture with its drawing, elements and gestures. No layer knows another.
 *
 * An unused layer has no painters, no elements, and takes no gestures.
 */
export interface Layer {
  /** The traits that it shows: a change redraws the picture. */
  readonly traits: readonly (keyof LaserTraits & string)[];
  /** Its painters at present, by depth. Layers of the same depth paint in the order of the list. */
  painters(): Partial<Record<Depth, Painter>>;
  /** Its painters of the index view, if there is one, by depth. */
  strip?(): Partial<Record<Depth, StripPainter>>;
  /** The inputs of its painters of the lower canvas, apart from the stage's geometry; a value for JSON. */
  lowerKey?(): unknown;
  /** Pixels that it needs below the picture. */
  roomBelow?(scan: Scan | null): number;
  /** Parts that it places round the rim of a scan: the picture leaves room for them. */
  rim?(sweep: Sweep, forward: number, theme: Theme): Rim[];
  /** Boxes of its elements at their places since the last drawing: labels and names give way to them. */
  covers?(): Box[];
  /** Updates its elements after the drawing. Layers at the end of the list come first. */
  place?(stage: Stage): void;

  // Gestures are offered to layers from the end of the list, until one takes them.
  /** A pointer is pressed. A layer that takes the drag gets no click when the pointer has moved. */
  onPress?(point: Point, isTouch: boolean): Drag | null;
  /** The pointer of a mouse or pen moves, or leaves (null). It leaves all layers below the one that takes it. */
  onHover?(point: Point | null): boolean;
  /** The tooltip of its drawing at a place; "" without one. */
  tip?(point: Point): string;
  onClick?(point: Point): boolean;
  onKey?(event: KeyboardEvent): boolean;
  readonly stops?: Stops;
}
