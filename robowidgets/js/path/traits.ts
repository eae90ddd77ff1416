import type { SampleTraits, Shape } from "../shared/traits.ts";
import type { LayerAbout } from "./layers.ts";

/** What Python says of the layers of a map. */
export interface MapAbout {
  layers?: LayerAbout[];
  /** Frames in which it may be drawn. */
  frames?: string[];
}

export interface PathTraits extends SampleTraits {
  /** Of each point, as float64: seconds, x, y in metres, yaw in radians, metres of the way so far. */
  _path: DataView;
  /** The frame in which the map is drawn; empty: the one that Python finds. */
  frame: string;
  /** Names of layers that are not drawn. */
  hidden: string[];
  follow: boolean;
  /** The ways of layers. */
  _tracks: DataView;
  /** Large grids. */
  _grids: DataView;
  _map: MapAbout;
}

/** A shape that the program drew, with the pose of its frame in that of the map. */
export interface PlacedShape extends Shape {
  from?: [x: number, y: number, yaw: number];
}
