import type { SampleTraits, Shape } from "../shared/traits.ts";
import type { LayerAbout } from "./layers.ts";

/** Facts about the layers of a map, from Python. */
export interface MapAbout {
  layers?: LayerAbout[];
  /** Frames in which it may be drawn. */
  frames?: string[];
}

export interface PathTraits extends SampleTraits {
  /** Of each point, as float64: seconds, x, y in metres, yaw in radians, metres of the path so far. */
  _path: DataView;
  /** The frame in which the map is drawn, or "" for the frame that Python finds. */
  frame: string;
  /** Names of layers that are not drawn. */
  hidden: string[];
  follow: boolean;
  /** The paths of layers. */
  _tracks: DataView;
  /** Large grids. */
  _grids: DataView;
  _map: MapAbout;
}

/** A shape that the program drew, with the pose of its frame in the frame of the map. */
export interface PlacedShape extends Shape {
  from?: [x: number, y: number, yaw: number];
}
