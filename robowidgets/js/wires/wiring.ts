import { Reader } from "../shared/bytes.ts";
import { type Frame, readHead } from "../shared/stream.ts";

/** A topic, as what connects nodes; fields that are not known are missing. */
export interface Wire {
  name: string;
  type: string;
  /** Numbers of the nodes that publish it, and of those that subscribe to it. */
  from: number[];
  to: number[];
  /** Whether its messages come here. */
  heard: boolean;
  /** Whether every node has it, such as /rosout. */
  plumbing: boolean;
  offered?: boolean;
  wanted?: boolean;
  /** Messages a second. */
  rate?: number;
  /** The last message in a few words, and the seconds since it came. */
  value?: string;
  age?: number;
  /** Whether it is listened to now and then alone, so that the age tells nothing of silence. */
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
  /** Whether it asks for speeds. */
  drives?: boolean;
  runs?: number;
  got?: string;
  gave?: string;
  problem?: string;
}

/** The wires of a robot at one time. */
export interface Wiring {
  nodes: string[];
  /** Whether the robot names nodes. */
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
