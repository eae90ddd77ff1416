import { Reader } from "../bytes.ts";
import { type Frame, readHead } from "../stream.ts";

export type TouchState = "free" | "touched" | "unknown";

export interface Sensor {
  name: string;
  state: TouchState;
  /** Number of touches. */
  touches: number;
  /** Seconds in this state when Python sent it; null before the first message about the sensor. */
  seconds: number | null;
}

export interface Touch extends Frame {
  sensors: Sensor[];
}

type Row = [name: string, state: TouchState, touches: number, seconds: number | null];

/** A frame of Python: the head, then a row per sensor as JSON. */
export function decodeTouch(bytes: DataView): Touch {
  const reader = new Reader(bytes);
  const head = readHead(reader);
  const rows: Row[] = JSON.parse(new TextDecoder().decode(reader.bytes(reader.left)));
  return { ...head, sensors: rows.map(([name, state, touches, seconds]) => ({ name, state, touches, seconds })) };
}
