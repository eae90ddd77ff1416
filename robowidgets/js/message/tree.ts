import type { Packed, Sent, Value } from "./frame.ts";
import type { Node } from "./traits.ts";

/** A field with its value. */
export interface Field {
  readonly node: Node;
  /** As the program writes it, after the message: `pose.position.x`, `ranges[3]`. */
  readonly path: string;
  /** The names in the path. */
  readonly steps: readonly string[];
  readonly value: Value;
  /** The bytes of arrays of its message. */
  readonly numbers: DataView;
  /** The parts of it that were sent; null if it has none, or none was sent. */
  readonly children: readonly Field[] | null;
}

/** The summary of an array of numbers. */
export interface Summary {
  count: number;
  least: Sent;
  most: Sent;
  nans: number;
  infinite: number;
  /** Place of its numbers in the bytes; -1 if they were not sent. */
  place: number;
}

const SIZES: Record<string, number> = {
  bool: 1,
  int8: 1,
  uint8: 1,
  int16: 2,
  uint16: 2,
  int32: 4,
  uint32: 4,
  float32: 4,
};

/** The fields of a message. */
export function toFields(
  nodes: readonly Node[],
  { values, numbers }: Pick<Packed, "values" | "numbers">,
  within: Pick<Field, "path" | "steps"> = { path: "", steps: [] },
): Field[] {
  return nodes.map((node, i) => {
    const value = values[i] ?? null;
    const field = { node, ...placeOf(within, node.name), value, numbers };
    const inner = { values: Array.isArray(value) ? value : [], numbers };
    return { ...field, children: node.children ? toFields(node.children, inner, field) : null };
  });
}

function placeOf({ path, steps }: Pick<Field, "path" | "steps">, name: string): Pick<Field, "path" | "steps"> {
  const joint = path && !name.startsWith("[") ? "." : "";
  return { path: path + joint + name, steps: [...steps, name] };
}

/** Returns true if the user can unfold it. */
export function canUnfold({ node }: Field): boolean {
  if (node.kind === "message") return (node.children?.length ?? node.folded ?? 0) > 0;
  return node.kind === "messages" ? (node.count ?? 0) > 0 : node.kind === "numbers" || node.kind === "texts";
}

/** The summary of a field that is an array of numbers. */
export function summaryOf({ value }: Field): Summary {
  const [count = 0, least = null, most = null, nans = 0, infinite = 0, place = -1] = value as number[];
  return { count, least, most, nans, infinite, place };
}

/** The numbers of an array from one index to another, as separate fields. */
export function elementsOf(field: Field, from: number, to: number): Field[] {
  const { node, numbers } = field;
  const { count, place } = summaryOf(field);
  const size = SIZES[node.type] ?? 8;
  const shown: Field[] = [];
  for (let i = from; i < Math.min(to, count) && place >= 0; i++) {
    const value =
      node.type === "bool" ? numbers.getUint8(place + i) === 1 : numberAt(numbers, place + i * size, node.type);
    const { unit, names } = node;
    const own: Node = { name: `[${i}]`, kind: node.type === "bool" ? "flag" : "number", type: node.type };
    if (unit) own.unit = unit;
    if (names) own.names = names;
    shown.push({ node: own, ...placeOf(field, own.name), value, numbers, children: null });
  }
  return shown;
}

function numberAt(bytes: DataView, at: number, type: string): Sent {
  switch (type) {
    case "int8":
      return bytes.getInt8(at);
    case "uint8":
      return bytes.getUint8(at);
    case "int16":
      return bytes.getInt16(at, true);
    case "uint16":
      return bytes.getUint16(at, true);
    case "int32":
      return bytes.getInt32(at, true);
    case "uint32":
      return bytes.getUint32(at, true);
    case "float32":
      return bytes.getFloat32(at, true);
    case "int64":
      return toSafe(bytes.getBigInt64(at, true));
    case "uint64":
      return toSafe(bytes.getBigUint64(at, true));
    default:
      return bytes.getFloat64(at, true);
  }
}

function toSafe(value: bigint): Sent {
  return Number.isSafeInteger(Number(value)) ? Number(value) : String(value);
}

/** The texts of an array that were sent, as separate fields. */
export function textsOf(field: Field): Field[] {
  const texts = (field.value as [number, Value[]])[1];
  return texts.map((value, i) => {
    const node: Node = { name: `[${i}]`, kind: "text", type: "string" };
    return { node, ...placeOf(field, node.name), value, numbers: field.numbers, children: null };
  });
}

/** A number for calculations; NaN without a value. */
export function toNumber(value: Value): number {
  if (typeof value !== "string") return typeof value === "number" ? value : NaN;
  return value.endsWith("inf") ? (value.startsWith("-") ? -Infinity : Infinity) : Number(value);
}

/** The field of a path; undefined if it was not sent. An element of an array has its number in the path. */
export function find(fields: readonly Field[], path: string): Field | undefined {
  for (const field of fields) {
    if (field.path === path) return field;
    const rest = path.startsWith(field.path) ? path.slice(field.path.length) : "";
    if (!/^[.[]/.test(rest)) continue;
    if (field.children) return find(field.children, path);
    const index = Number(/^\[(\d+)\]$/.exec(rest)?.[1] ?? NaN);
    if (field.node.kind === "numbers") return elementsOf(field, index, index + 1)[0];
    if (field.node.kind === "texts") return textsOf(field)[index];
  }
  return undefined;
}

/** Returns true if two fields of one path have the same value. */
export function isSame(one: Field, other: Field | undefined): boolean {
  if (one.node.kind !== other?.node.kind) return false;
  if (one.node.kind === "numbers") {
    const [a, b] = [summaryOf(one), summaryOf(other)];
    const isAlike = a.count === b.count && a.nans === b.nans && a.infinite === b.infinite;
    if (!isAlike || a.least !== b.least || a.most !== b.most) return false;
    const elements = elementsOf(other, 0, b.count);
    return elementsOf(one, 0, a.count).every(({ value }, i) => Object.is(value, elements[i]?.value));
  }
  const [a, b] = [one.children, other.children];
  if (!a || !b) return JSON.stringify(one.value) === JSON.stringify(other.value);
  return a.length === b.length && a.every((field, i) => field.path === b[i]?.path && isSame(field, b[i]));
}
