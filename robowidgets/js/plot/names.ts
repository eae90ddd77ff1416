import { firstWhere } from "../shared/search.ts";

/** The topic of a line, and its field; a name without a field is the topic. */
export function split(name: string): [string, string] {
  const at = name.startsWith("/") ? name.indexOf(".") : -1;
  return at < 0 ? [name, ""] : [name.slice(0, at), name.slice(at + 1)];
}

const PARTS = /^(d\/dt )?(.*?)( \(.*\))?$/;

/**
 * The shortest names that distinguish lines: the end of the topic, "odom"; for several fields of a topic the end of the
 * field, "linear.x"; else the whole name. A derivative, and a line of another recording, is named after its own line.
 *
 * @param names of the lines of a graph
 * @param plot names of the lines of all its graphs
 */
export function toLabels(names: string[], plot = names): string[] {
  const parts = names.map((name) => (PARTS.exec(name) ?? []).slice(1).map((part) => part ?? ""));
  const own = [...new Set(parts.map(([, base = ""]) => base))];
  const short = shortest(own, [...new Set(plot.map(baseOf))]);
  return parts.map(([before = "", base = "", after = ""]) => `${before}${short[own.indexOf(base)]}${after}`);
}

/** The short name of a difference: "one − other" of "nearest (one)" and "nearest (other)". */
export function toDifference(labels: [string, string]): string {
  const [one, other] = labels.map((label) => /^(.*) \((.*)\)$/.exec(label));
  const of = one && other && one[1] === other[1] ? [one[2], other[2]] : labels;
  return of.join(" \u2212 ");
}

/** The field of a line; "" for a name without one. */
export function fieldOf(name: string): string {
  return split(baseOf(name))[1];
}

/** The line from which a derivative, or the same line of another recording, is made. */
function baseOf(name: string): string {
  return PARTS.exec(name)?.[2] ?? "";
}

function shortest(names: string[], plot: string[]): string[] {
  const [only = ""] = names;
  const isOfItsTopic = (name: string) => split(name)[0] === split(only)[0];
  // A line alone in its graph is distinguished from the lines of its topic in other graphs.
  const others = names.length === 1 ? plot.filter(isOfItsTopic) : names;
  const ways = [
    (name: string) => split(name)[0].split("/").filter(Boolean).at(-1) ?? name,
    (name: string) => lastOf(split(name)[1], 1) || name,
    (name: string) => lastOf(split(name)[1], 2) || name,
    (name: string) => `${split(name)[0].split("/").at(-1)} ${lastOf(split(name)[1], 2)}`.trim(),
  ];
  for (const way of ways) {
    if (new Set(others.map(way)).size === others.length) return names.map(way);
  }
  return names;
}

function lastOf(field: string, count: number): string {
  return field.split(".").slice(-count).join(".");
}

/** Heights of labels: near the wanted ones, in their order, and far enough apart to be readable. */
export function spread(wanted: number[], apart: number, top: number, bottom: number): number[] {
  const order = wanted.map((_, i) => i).sort((a, b) => (wanted[a] as number) - (wanted[b] as number));
  const places = order.map((i) => wanted[i] as number);
  for (let i = 0; i < places.length; i++) {
    const least = i ? (places[i - 1] as number) + apart : top;
    places[i] = Math.max(places[i] as number, least);
  }
  for (let i = places.length - 1, most = bottom; i >= 0; i--, most = (places[i + 1] as number) - apart) {
    places[i] = Math.min(places[i] as number, most);
  }
  const found: number[] = [];
  for (const [place, i] of order.entries()) found[i] = places[place] as number;
  return found;
}

/** The number of times that spans hold within some time, and their duration. */
export function holding(marks: [number, number, string][], [start, end]: [number, number]): [number, number] {
  const last = firstWhere(marks, ([from]) => from > end);
  const inside = marks.slice(0, last).filter(([, to]) => to >= start);
  const seconds = inside.reduce((sum, [from, to]) => sum + Math.min(to, end) - Math.max(from, start), 0);
  return [inside.length, seconds];
}
