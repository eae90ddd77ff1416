import { asSentence, toClock, toCount, toDegrees, toFixed, toMany } from "../shared/format.ts";
import { isName, quoted } from "../shared/python.ts";
import type { Value } from "./frame.ts";
import { elementsOf, type Field, summaryOf, toNumber } from "./tree.ts";

const MINUS = "\u2212";
/** Characters up to which a number is shown with all its digits. */
const LONGEST = 10;
/** Smaller numbers have an exponent: their zeros would take the room of their digits. */
const TINY = 1e-4;
/** From here on, seconds are a time of day. */
const DATED = 1e8;

/** The texts of a value: the value, its unit, and more in gray. */
export interface Said {
  text: string;
  unit: string;
  /** After the value: the number of a name, or the value in the message. */
  more: string;
  /** True if nothing was measured. */
  isNone: boolean;
}

/** A number with all its digits: the fewest that make this float32 or float64. */
export function toExact(value: Value, type: string): string {
  if (typeof value === "string" && !/nan|inf/.test(value)) return value.replace("-", MINUS);
  const number = toNumber(value);
  if (!Number.isFinite(number)) return toFixed(number, 0);
  return withMinus(type === "float32" ? shortestOf(number) : String(number));
}

/** A number's text with a real minus sign, in its exponent, too. */
function withMinus(text: string): string {
  return text.replaceAll("-", MINUS);
}

/** The shortest text that is this float32. */
function shortestOf(value: number): string {
  for (let digits = 6; digits < 9; digits++) {
    const short = Number(value.toPrecision(digits));
    if (Math.fround(short) === value) return String(short);
  }
  return String(Number(value.toPrecision(9)));
}

/** A number for reading while it changes: all its digits if they are few, else seven. */
export function toReadable(value: Value, type: string, digits = 7): string {
  const exact = toExact(value, type);
  if (exact.length <= LONGEST && digits === 7) return exact;
  const number = toNumber(value);
  if (!Number.isFinite(number) || (Number.isInteger(number) && Math.abs(number) < 1e15)) return exact;
  const rounded = Number(number.toPrecision(digits));
  const short = withMinus(Math.abs(rounded) < TINY ? rounded.toExponential() : String(rounded));
  return short.length < exact.length ? short : exact;
}

/** The name of a number, or the names of its bits. */
export function nameOf(value: Value, names: Record<string, string> | undefined): string {
  const own = names?.[String(value)];
  if (own !== undefined || !names) return own ?? "";
  const bits = Object.keys(names).map(Number);
  if (typeof value !== "number" || value <= 0 || bits.some((bit) => bit < 0 || (bit & (bit - 1)) !== 0)) return "";
  const set = bits.filter((bit) => bit && value & bit);
  return set.length > 1 && set.reduce((sum, bit) => sum + bit, 0) === value
    ? set.map((bit) => names[bit]).join(" + ")
    : "";
}

/** The texts next to the name of a field. @param digits number of digits, if a number has many */
export function toSaid(field: Field, digits = 7): Said {
  const { node, value } = field;
  const said = { text: "", unit: node.unit ?? "", more: "", isNone: false };
  switch (node.kind) {
    case "number": {
      const name = nameOf(value, node.names);
      if (name) return { ...said, text: name, more: toExact(value, node.type) };
      if (value === null || value === "nan") {
        return { ...said, text: value === null ? "no value" : "not measured (NaN)", unit: "", isNone: true };
      }
      return { ...said, text: toReadable(value, node.type, digits) };
    }
    case "flag":
      return { ...said, text: String(value) };
    case "time":
      return { ...said, ...toTime(value as number[]) };
    case "text":
      return { ...said, text: toText(value), more: toRest(value) };
    default:
      return { ...said, ...toSum(field) };
  }
}

/** A text, which may be the beginning of a longer one. */
export function toText(value: Value): string {
  return String(Array.isArray(value) ? value[0] : value);
}

function toRest(value: Value): string {
  return Array.isArray(value) ? `${toMany(Number(value[1]), "character")}` : "";
}

function toTime([seconds = 0, nanoseconds = 0]: number[]): Partial<Said> {
  const digits = String(nanoseconds).padStart(9, "0");
  if (seconds < DATED) {
    if (!seconds && !nanoseconds) return { text: "0" };
    const [whole, part] = seconds < 0 && nanoseconds ? [seconds + 1, 1e9 - nanoseconds] : [seconds, nanoseconds];
    const sign = seconds < 0 ? MINUS : "";
    return { text: `${sign}${Math.abs(whole)}.${String(part).padStart(9, "0").slice(0, 3)}` };
  }
  const [, timeOfDay] = toClock(seconds);
  return { text: `${timeOfDay}.${digits.slice(0, 3)}`, unit: "UTC" };
}

/** The text of a folded message or array. */
function toSum(field: Field): Partial<Said> {
  const { node, children } = field;
  if (node.kind === "messages") return { text: toLength(node.count ?? 0), unit: "", isNone: !node.count };
  if (node.kind === "texts") {
    const [count = 0, texts = []] = field.value as [number, Value[]];
    return { text: `${toLength(count)} ${texts.slice(0, 2).map(toText).join(", ")}${count > 2 ? " \u2026" : ""}` };
  }
  if (node.kind === "numbers") return { text: toSpan(field), unit: node.unit ?? "", isNone: !summaryOf(field).count };
  if (node.folded) return { text: toMany(node.folded, "field"), unit: "" };
  const turn = children && yawOf(children);
  if (turn !== null && turn !== undefined) return { text: `${toDegrees(turn.yaw)} yaw`, unit: "" };
  const length = children && lengthOf(field);
  return length ?? { text: "", unit: "" };
}

function toLength(count: number): string {
  return `[${toCount(count)}]`;
}

/** "[360] 0.16 to 5.64, 5 not measured" */
function toSpan(field: Field): string {
  const { count, least, most, nans, infinite } = summaryOf(field);
  if (!count) return "[0]";
  const type = field.node.type;
  if (type === "bool") {
    const set = elementsOf(field, 0, count).filter(({ value }) => value).length;
    return `${toLength(count)} ${set ? `${toCount(set)} true` : "all false"}`;
  }
  if (isCovariance(field) && least === 0 && most === 0) return "all 0: not known";
  if (isCovariance(field) && least === -1) return "\u22121: not measured";
  const ends = least === null ? "" : least === most ? `all ${toReadable(least, type)}` : "";
  const span = ends || (least === null ? "" : `${toReadable(least, type, 4)} to ${toReadable(most, type, 4)}`);
  const more = [nans ? `${toCount(nans)} not measured` : "", infinite ? `${toCount(infinite)} infinite` : ""];
  return `${toLength(count)} ${[span, ...more].filter(Boolean).join(", ")}`;
}

/** Angles of a quaternion, radians; null if these fields are not a quaternion. */
export function yawOf(fields: readonly Field[]): { roll: number; pitch: number; yaw: number } | null {
  if (fields.map(({ node }) => node.name).join("") !== "xyzw") return null;
  const [x = NaN, y = NaN, z = NaN, w = NaN] = fields.map(({ value }) => toNumber(value));
  const size = Math.hypot(x, y, z, w);
  // A quaternion that was never set is all 0, and has no direction.
  if (!(Math.abs(size - 1) < 0.1)) return null;
  const roll = Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y));
  const pitch = Math.asin(Math.max(-1, Math.min(1, 2 * (w * y - z * x))));
  return { roll, pitch, yaw: Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)) };
}

/** The length of a vector, unless it is a position. */
function lengthOf({ node, children }: Field): Partial<Said> | null {
  const parts = children ?? [];
  const unit = parts[0]?.node.unit ?? "";
  const isVector = parts.map((part) => part.node.name).join("") === "xyz" && parts.every(isNumber);
  if (!isVector || unit === "m" || !/Vector3$|^$/.test(node.type)) return null;
  const length = Math.hypot(...parts.map(({ value }) => toNumber(value)));
  return Number.isNaN(length) ? null : { text: withMinus(String(Number(length.toPrecision(3)))), unit };
}

function isNumber({ node }: Field): boolean {
  return node.kind === "number";
}

function isCovariance({ node }: Field): boolean {
  return node.kind === "numbers" && /(^|_)covariance$/.test(node.name);
}

/** A note from the definition about a surprising value, or "". */
export function noteOf(field: Field): string {
  const { node, value } = field;
  if (isCovariance(field)) {
    const { count, least, most } = summaryOf(field);
    if (count && least === 0 && most === 0) return "all 0: by the definition the covariance is not known, not zero";
    if (least === -1) return "\u22121 in the first element: by the definition this was not measured";
  }
  if (node.kind === "number" && node.name === "percentage" && typeof value === "number" && value >= 0 && value <= 1) {
    return "goes from 0 to 1";
  }
  return "";
}

/** All of a value, for the foot: each digit, and each character that was sent. */
export function toWhole(field: Field): string {
  const { node, value } = field;
  if (node.kind === "number") {
    const name = nameOf(value, node.names);
    return [name, `${toExact(value, node.type)} ${node.unit ?? ""}`.trim()].filter(Boolean).join(" = ");
  }
  if (node.kind === "time") {
    const [seconds = 0, nanoseconds = 0] = value as number[];
    const date = seconds >= DATED ? `${toClock(seconds).join(" ")} UTC, ` : "";
    return `${date}sec ${seconds}, nanosec ${nanoseconds}`;
  }
  if (node.kind === "text" && Array.isArray(value)) {
    return `the first ${toMany(toText(value).length, "character")} of ${toCount(Number(value[1]))}: ${toText(value)}`;
  }
  const { text, unit } = toSaid(field);
  return `${text} ${unit}`.trim();
}

/** The code that reads a field of a message. */
export function toCode({ steps }: Field, isKeyed: boolean, message = "message"): string {
  // Fields that are shown alone have their path as name.
  const keys = steps.flatMap((step) => step.split(/\.|(?=\[\d+\])/));
  return keys.reduce((code, key) => {
    if (/^\[\d+\]$/.test(key)) return code + key;
    if (isKeyed || !/^[A-Za-z_]\w*$/.test(key)) return `${code}[${quoted(key)}]`;
    return isName(key) ? `${code}.${key}` : `getattr(${code}, ${quoted(key)})`;
  }, message);
}

const SPOKEN: Record<string, string> = {
  m: "metres",
  "m/s": "metres per second",
  "m/s\u00b2": "metres per second squared",
  rad: "radians",
  "rad/s": "radians per second",
  s: "seconds",
  V: "volts",
  A: "amperes",
  Ah: "ampere hours",
  "\u00b0C": "degrees Celsius",
};

/** The text of a row for a screen reader. */
export function toSpoken(field: Field, isChanged: boolean): string {
  const { text, unit, more } = toSaid(field);
  const name = field.path.replaceAll(".", ", ").replaceAll("_", " ");
  const value = [text, SPOKEN[unit] ?? unit].filter(Boolean).join(" ");
  const note = noteOf(field);
  return [name, value, more, note, isChanged ? "changed" : ""].filter(Boolean).join(", ");
}

/** The words of a note as the foot has them. */
export function toNote(field: Field): string {
  return asSentence(noteOf(field));
}
