import { Reader } from "../shared/bytes.ts";
import { type Frame, readHead } from "../shared/stream.ts";

/** A topic, as a connection of nodes; unknown fields are missing. */
export interface Wire {
  name: string;
  type: string;
  /** Numbers of the nodes that publish it, and of the nodes that subscribe to it. */
  from: number[];
  to: number[];
  /** True if its messages are received here. */
  heard: boolean;
  /** True if every node has it, such as /rosout. */
  plumbing: boolean;
  offered?: boolean;
  wanted?: boolean;
  /** Messages a second. */
  rate?: number;
  /** The last message in a few words, and the seconds since it arrived. */
  value?: string;
  age?: number;
  /** True if it is only sampled now and then, so that its age does not show a silence. */
  glanced?: boolean;
  /** Messages in a recording. */
  count?: number;
  note?: string;
}

/** A part of the notebook. */
export interface Part {
  kind: "function" | "condition" | "program" | "speeds" | "widget";
  name: string;
  reads?: string[];
  writes?: string[];
  /** True if it sends speeds. */
  drives?: boolean;
  runs?: number;
  got?: string;
  gave?: string;
  problem?: string;
}

/** The wires of a robot at one time. */
export interface Wiring {
  nodes: string[];
  /** True if the robot names nodes. */
  tells: boolean;
  note: string;
  wires: Wire[];
  parts: Part[];
}

export type WiringFrame = Frame & Wiring;

/** A frame of Python: the head, then JSON. */
export function decodeWiring(bytes: DataView): WiringFrame {
  const reader = new Reader(bytes);
  const head = readHead(reader);
  return { ...JSON.parse(new TextDecoder().decode(reader.bytes(reader.left))), ...head };
}
