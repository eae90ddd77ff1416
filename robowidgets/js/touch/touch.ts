import { Reader } from "../shared/bytes.ts";
import { type Frame, readHead } from "../shared/stream.ts";

export type TouchState = "free" | "touched" | "unknown";

export interface Sensor {
  name: string;
  state: TouchState;
  /** How often it was touched. */
  touches: number;
  /** Seconds in this state when Python sent it; null while no message has named the sensor. */
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

/** The sensors of these names, in their order, UNKNOWN where no message has named them; all sensors for no names. */
export function select(sensors: Sensor[], names: string[]): Sensor[] {
  if (names.length === 0) return sensors;
  const known = new Map(sensors.map((sensor) => [sensor.name, sensor]));
  return names.map((name) => known.get(name) ?? { name, state: "unknown", touches: 0, seconds: null });
}
