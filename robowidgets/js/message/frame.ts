import { Reader } from "../shared/bytes.ts";
import { type Frame, readHead } from "../shared/stream.ts";

/** A number as it was sent: as text if JSON has no such number, or a page would round it; null without a value. */
export type Sent = number | string | null;

/** The values of a message, which are nested as its nodes are. */
export type Value = Sent | boolean | Value[];

export interface Packed extends Frame {
  values: Value[];
  /** The bytes of arrays. */
  numbers: DataView;
}

/** A frame of Python: the head, the length of the JSON, the JSON, then the numbers of arrays. */
export function decodeMessage(bytes: DataView): Packed {
  const reader = new Reader(bytes);
  const head = readHead(reader);
  const [length] = new Uint32Array(reader.bytes(4));
  const values: Value[] = JSON.parse(new TextDecoder().decode(reader.bytes(length ?? 0)));
  return { ...head, values, numbers: new DataView(reader.bytes(reader.left)) };
}
