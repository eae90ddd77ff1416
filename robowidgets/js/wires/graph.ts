import type { Part, Wire, Wiring } from "./wiring.ts";

/** Boxes up to which no namespace is folded by default. */
export const MANY = 36;
/** Names that a namespace must have to be folded. */
const LEAST = 3;

export type BoxKind = "node" | "topic" | "part" | "fold";

/** A box of the picture: a node, a topic, a part of the notebook, or a namespace that is folded. */
export interface Item {
  /** The same for the same thing at any time. */
  key: string;
  kind: BoxKind;
  name: string;
  wire?: Wire;
  part?: Part;
  /** The group that it belongs to, such as "topics /camera", or "". */
  group: string;
  /** Names that are folded into it. */
  members?: string[];
}

export interface Graph {
  items: Map<string, Item>;
  /** Pairs of keys, from the publishing box to the receiving one. */
  links: [from: string, to: string][];
  /** Names that are left out because every node has them. */
  plumbing: number;
  /** Names that the filter leaves out. */
  filtered: number;
}

/** Choices of the user. */
interface Choice {
  filter: string;
  infrastructure: boolean;
  unfolded: readonly string[];
}

/** Nodes of tools, and of bridges, which only serve to inspect the robot. */
const TOOL = /^\/(_|rosout$|rosapi$|rosbridge|foxglove_bridge|launch_ros_|transform_listener_impl_)|\/_[^/]*$/;

/** The graph of the wires to draw. */
export function toGraph(wiring: Wiring, { filter, infrastructure, unfolded }: Choice): Graph {
  const items = new Map<string, Item>();
  const links = new Map<string, [string, string]>();
  const link = (from: string, to: string) => {
    if (from !== to) links.set(`${from}\n${to}`, [from, to]);
  };
  const add = (item: Item) => items.set(item.key, item);
  const isTool = (node: string) => !infrastructure && TOOL.test(node);
  // The nodes with most publications first: messages go to the right from there.
  const published = wiring.nodes.map((_, number) => wiring.wires.filter(({ from }) => from.includes(number)).length);
  const order = [...wiring.nodes.keys()].sort((a, b) => (published[b] ?? 0) - (published[a] ?? 0));
  const shown = wiring.wires.filter(({ plumbing }) => infrastructure || !plumbing);
  const there = new Set(shown.map(({ name }) => name));
  const tools = new Set<string>();
  const wired = new Set(shown.flatMap(({ from, to }) => [...from, ...to]));
  for (const number of order) {
    const name = wiring.nodes[number] ?? "";
    if (!wired.has(number)) continue;
    if (isTool(name)) tools.add(name);
    else add({ key: `node ${name}`, kind: "node", name, group: groupOf("nodes", name) });
  }
  for (const wire of shown) {
    const key = `topic ${wire.name}`;
    add({ key, kind: "topic", name: wire.name, wire, group: groupOf("topics", wire.name) });
    for (const [numbers, isFrom] of [
      [wire.from, true],
      [wire.to, false],
    ] as const) {
      for (const number of numbers) {
        const node = `node ${wiring.nodes[number] ?? ""}`;
        if (!items.has(node)) continue;
        if (isFrom) link(node, key);
        else link(key, node);
      }
    }
  }
  const speeds = wiring.parts.findIndex(({ kind }) => kind === "speeds");
  for (const [i, part] of wiring.parts.entries()) {
    const key = partKey(part, i, wiring.parts);
    add({ key, kind: "part", name: part.name, part, group: "" });
    for (const topic of part.reads ?? []) if (there.has(topic)) link(`topic ${topic}`, key);
    for (const topic of part.writes ?? []) if (there.has(topic)) link(key, `topic ${topic}`);
    if (part.drives && speeds >= 0) link(key, partKey(wiring.parts[speeds] as Part, speeds, wiring.parts));
  }
  const plumbing = wiring.wires.length - shown.length + tools.size;
  const all = { items, links: [...links.values()], plumbing, filtered: 0 };
  return fold(narrow(all, filter.trim().toLowerCase()), unfolded);
}

/** Unique keys for parts of the same kind and name, in their order. */
function partKey({ kind, name }: Part, index: number, parts: Part[]): string {
  const before = parts.slice(0, index).filter((one) => one.kind === kind && one.name === name).length;
  return `${kind} ${name} ${before}`;
}

/** The namespace in which a name stands, with the kind: "topics /camera" for /camera/left/image. */
function groupOf(kind: string, name: string): string {
  const parts = name.split("/");
  return parts.length > 2 && parts[1] ? `${kind} /${parts[1]}` : "";
}

/** Keeps the items whose name contains the text, and their neighbours. */
function narrow(graph: Graph, text: string): Graph {
  if (!text) return graph;
  const has = ({ name, wire }: Item) => [name, wire?.type ?? ""].some((word) => word.toLowerCase().includes(text));
  const found = new Set([...graph.items.values()].filter(has).map(({ key }) => key));
  const kept = new Set(found);
  for (const [from, to] of graph.links) {
    if (found.has(from)) kept.add(to);
    if (found.has(to)) kept.add(from);
  }
  const items = new Map([...graph.items].filter(([key]) => kept.has(key)));
  const links = graph.links.filter(
    ([from, to]) => kept.has(from) && kept.has(to) && (found.has(from) || found.has(to)),
  );
  return { ...graph, items, links, filtered: graph.items.size - items.size };
}

/** Folds the largest namespaces, until not many boxes are left. */
function fold(graph: Graph, unfolded: readonly string[]): Graph {
  const groups = new Map<string, Item[]>();
  for (const item of graph.items.values()) {
    if (item.group) groups.set(item.group, [...(groups.get(item.group) ?? []), item]);
  }
  const largest = [...groups]
    .filter(([, members]) => members.length >= LEAST)
    .sort(([, a], [, b]) => b.length - a.length);
  const folded = new Map<string, string>();
  const items = new Map(graph.items);
  for (const [group, members] of largest) {
    if (items.size <= MANY) break;
    if (unfolded.includes(group)) continue;
    for (const { key } of members) {
      items.delete(key);
      folded.set(key, group);
    }
    const names = members.map(({ name }) => name);
    items.set(group, { key: group, kind: "fold", name: group.split(" ")[1] ?? "", group, members: names });
  }
  const links = new Map<string, [string, string]>();
  for (const [from, to] of graph.links) {
    const [a, b] = [folded.get(from) ?? from, folded.get(to) ?? to];
    if (a !== b) links.set(`${a}\n${b}`, [a, b]);
  }
  return { ...graph, items, links: [...links.values()] };
}

/** The boxes that are wired to one, including itself. */
export function around({ links }: Pick<Graph, "links">, key: string): Set<string> {
  return new Set([key, ...links.flatMap(([from, to]) => (from === key ? [to] : to === key ? [from] : []))]);
}
