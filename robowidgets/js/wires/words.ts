import { toAge, toCount, toFixed, toMany } from "../shared/format.ts";
import { listedSilentAfter } from "../shared/staleness.ts";
import type { Item } from "./graph.ts";
import type { Part, Wire, Wiring } from "./wiring.ts";

const MOST_NAMES = 6;

/** "10.0 Hz", "14 messages" of a recording; "" if unknown. */
export function rateOf({ rate, count, value }: Wire): string {
  if (rate !== undefined) return `${toFixed(rate, 1)} Hz`;
  if (count !== undefined) return count === 1 ? "once" : `${toCount(count)} \u00d7`;
  return value === undefined ? "" : "once";
}

/** Returns true if the newest message of a topic with a rate is too old. */
export function isSilent({ rate, age = 0, glanced = false }: Wire): boolean {
  return rate !== undefined && !glanced && 1000 * age > listedSilentAfter(1000 / rate);
}

/** The line below the name of a topic. */
export function sayingOf(wire: Wire): string {
  if (wire.note) return wire.note;
  if (wire.value !== undefined) return isSilent(wire) ? `silent for ${toAge(1000 * (wire.age ?? 0))}` : wire.value;
  if (wire.offered === false) return "nobody publishes it";
  return wire.heard ? "no message yet" : shortType(wire.type);
}

/** "LaserScan" for "sensor_msgs/msg/LaserScan". */
export function shortType(type: string): string {
  return type
    .split(", ")
    .map((one) => one.split("/").at(-1))
    .join(", ");
}

/** "12 times", the runs of a part. */
export function runsOf({ runs, kind }: Part): string {
  if (runs === undefined) return kind === "widget" ? "" : "not yet";
  return `${toCount(runs)} \u00d7`;
}

/** The text below the picture about an item: its kind, facts about it, and its values, each a line. */
export function describe(item: Item, wiring: Wiring): { kind: string; facts: string[]; lines: string[] } {
  const { wire, part, members } = item;
  if (members)
    return {
      kind: item.key.startsWith("nodes") ? "nodes" : "topics",
      facts: [toMany(members.length, "name")],
      lines: [names(members)],
    };
  if (part) {
    const got = part.got && (part.kind === "speeds" ? `asked for by ${part.got}` : `got ${part.got}`);
    const gave = part.gave && (part.kind === "speeds" ? `sent ${part.gave}` : `gave ${part.gave}`);
    const facts = [runsOf(part), `reads ${names(part.reads ?? []) || "no topic"}`];
    if (part.writes?.length) facts[1] = `publishes ${names(part.writes)}`;
    if (part.drives) facts.push("drives");
    return {
      kind: part.kind,
      facts: facts.filter(Boolean),
      lines: [part.problem ?? "", got ?? "", gave ?? ""].filter(Boolean),
    };
  }
  if (wire) {
    const age = wire.age === undefined ? "" : `${toAge(1000 * wire.age, 2)} old`;
    const [from, to] = [wire.from, wire.to].map((numbers) => names(numbers.map((i) => wiring.nodes[i] ?? "")));
    const takers = wiring.parts.filter(({ reads }) => reads?.includes(wire.name)).map(({ name }) => name);
    const here = takers.length ? `here to ${names(takers)}` : "";
    const facts = [wire.type || "type unknown", rateOf(wire), age];
    const way = [from && `from ${from}`, to && `to ${to}`, here].filter(Boolean).join(", ");
    const said = wire.value ?? (wire.heard ? "" : "not listened to");
    return { kind: "topic", facts: facts.filter(Boolean), lines: [wire.note ?? "", said, way].filter(Boolean) };
  }
  const number = wiring.nodes.indexOf(item.name);
  const published = wiring.wires.filter(({ from }) => from.includes(number)).map(({ name }) => name);
  const taken = wiring.wires.filter(({ to }) => to.includes(number)).map(({ name }) => name);
  const lines = [published.length && `publishes ${names(published)}`, taken.length && `gets ${names(taken)}`];
  return {
    kind: "node",
    facts: [toMany(published.length + taken.length, "topic")],
    lines: lines.filter((line) => line !== 0),
  };
}

function names(all: string[]): string {
  const rest = all.length - MOST_NAMES;
  return all.slice(0, MOST_NAMES).join(", ") + (rest > 0 ? ` and ${rest} more` : "");
}
