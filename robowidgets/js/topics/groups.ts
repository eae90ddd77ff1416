import type { TopicRow } from "./traits.ts";

/** Rows under one heading; without one, single topics. */
export interface Group {
  /** The first part of their names, with its slash; "" for single topics. */
  name: string;
  /** True if they cannot be read. */
  isUnreadable: boolean;
  rows: TopicRow[];
}

/** Rows of a group that is too small to be folded by default. */
const SMALL = 4;
const UNREADABLE = "Not readable";

/** Topics in groups by the first part of their names: single ones first, those that cannot be read last. */
export function toGroups(rows: TopicRow[], filter = ""): Group[] {
  const words = filter.toLowerCase().split(/\s+/).filter(Boolean);
  const found = rows.filter(({ name, type }) => words.every((word) => `${name} ${type}`.toLowerCase().includes(word)));
  const readable = found.filter(({ problem }) => !problem);
  const byPart = new Map<string, TopicRow[]>();
  for (const row of readable) {
    const part = firstPart(row.name);
    byPart.set(part, [...(byPart.get(part) ?? []), row]);
  }
  const isAlone = (row: TopicRow) => !firstPart(row.name) || byPart.get(firstPart(row.name))?.length === 1;
  const groups: Group[] = [{ name: "", isUnreadable: false, rows: readable.filter(isAlone) }];
  for (const [name, own] of byPart) {
    if (name && own.length > 1) groups.push({ name, isUnreadable: false, rows: own });
  }
  const unreadable = found.filter(({ problem }) => problem);
  groups.push({ name: UNREADABLE, isUnreadable: true, rows: unreadable });
  return groups.filter((group) => group.rows.length);
}

/** `/camera` of `/camera/image`; "" for `/scan`. */
function firstPart(name: string): string {
  const end = name.indexOf("/", 1);
  return end > 0 && end < name.length - 1 ? name.slice(0, end) : "";
}

/**
 * The folded groups: by the user's choice, and else the last ones of many rows without a topic on show, until all
 * fit.
 *
 * @param lines the number of rows that have room
 */
export function toFolded(
  groups: Group[],
  isShown: (name: string) => boolean,
  lines: number,
  byHand: ReadonlyMap<string, boolean>,
): Set<string> {
  const folded = new Set<string>();
  const heightOf = (group: Group) => (group.name ? 1 : 0) + (folded.has(group.name) ? 0 : group.rows.length);
  for (const { name } of groups) if (byHand.get(name)) folded.add(name);
  for (const group of [...groups].reverse()) {
    const height = groups.reduce((sum, one) => sum + heightOf(one), 0);
    if (height <= lines) break;
    const isOpen = byHand.get(group.name) === false || group.rows.some(({ name }) => isShown(name));
    if (group.name && !isOpen && group.rows.length > SMALL) folded.add(group.name);
  }
  return folded;
}

/** Returns true if a laser can show a topic, too: a cloud, or a topic with the name of a depth image. */
export function canBeLaser({ name, widget, problem }: TopicRow): boolean {
  return !problem && (widget === "cloud" || (widget === "image" && /depth/i.test(name)));
}

/** The label of a row in its group: `image` of `/camera/image`. */
export function nameIn(group: Group, name: string): string {
  return group.name && !group.isUnreadable ? name.slice(group.name.length + 1) : name;
}

/** `LaserScan` of `sensor_msgs/msg/LaserScan`; several are joined by a comma. */
export function shortType(type: string): string {
  return type
    .split(", ")
    .map((one) => one.slice(one.lastIndexOf("/") + 1))
    .join(", ");
}

/** A rate for the narrow column: "100", "9.8", "0.33"; "once" for one message. */
export function toRate(count: number | null, rate: number | null): string {
  if (count === 1) return "once";
  if (rate === null) return "";
  return rate >= 10 ? rate.toFixed(0) : rate >= 0.995 ? rate.toFixed(1).replace(/\.0$/, "") : rate.toFixed(2);
}

/** A count for the narrow column: "58", "5.8k", "1.2M". */
export function toCount(count: number | null): string {
  if (count === null) return "";
  if (count < 1000) return `${count}`;
  const [size, unit] = count < 1e6 ? [count / 1e3, "k"] : [count / 1e6, "M"];
  return `${size < 10 ? size.toFixed(1) : size.toFixed(0)}${unit}`;
}

/** Count and rate in words: "5,803 messages · 100.0 Hz"; empty if both are unknown. */
export function toFacts(count: number | null, rate: number | null): string[] {
  const facts: string[] = [];
  if (count !== null) facts.push(`${count.toLocaleString("en")} ${count === 1 ? "message" : "messages"}`);
  if (rate !== null) facts.push(`${rate.toFixed(rate < 1 ? 2 : 1)} Hz`);
  return facts;
}

/** The part of a topic's value that fits into a row: its first number or word, without the names before it. */
export function toFewWords(said: string): string {
  if (said === "nothing yet") return "\u2013";
  if (said.startsWith('"')) return said.replaceAll('"', "");
  const [first = ""] = said.split(/, (?![^[]*\])/);
  return first.replace(/^nearest /, "").replace(/^[A-Za-z_]\S*\.(?=\S+ )/, "");
}
