import type { Box, Point, Size } from "../shared/box.ts";
import { arrange } from "../shared/graph/arrange.ts";
import { type Edge, route } from "../shared/graph/route.ts";
import type { Graph, Item } from "./graph.ts";

const [NODE, TOPIC, PART, PLAIN] = [30, 42, 60, 30];
const [LEAST, MOST] = [84, 250];
const WORDS = 24;
/** Room in a topic for its rate, behind its name. */
const RATE = 64;
const TOPIC_LEAST = 166;
const PART_WIDTH = 204;
const GAP = 10;

export interface PlacedLink {
  from: string;
  to: string;
  points: [x: number, y: number][];
}

export interface Placed extends Size {
  boxes: Map<string, Box>;
  links: PlacedLink[];
}

/**
 * Places the boxes from left to right, in the direction of messages. Boxes without wires stand below, in rows.
 *
 * @param measure width of a text in the picture
 * @param room width that rows of boxes without wires may take
 */
export function place({ items, links }: Graph, measure: (text: string) => number, room: number): Placed {
  const wired = new Set(links.flat());
  const sizes = new Map([...items.values()].map((item) => [item.key, sizeOf(item, measure)] as const));
  const within = new Map([...sizes].filter(([key]) => wired.has(key)));
  const arrows = links.map(([source, target]) => ({ source, target }));
  const ranksep = 34 + Math.min(76, links.length / 3);
  const arranged = arrange(within, arrows, { rankdir: "LR", nodesep: GAP, edgesep: 7, ranksep });
  // Arrows are routed between rows, so rows must run across: x and y change places.
  const turned = new Map([...arranged.boxes].map(([key, box]) => [key, turn(box)] as const));
  const edges = arranged.edges.map((edge): Edge => {
    return { ...edge, label: turn(edge.label), via: edge.via.map(({ x, y }): Point => ({ x: y, y: x })) };
  });
  const points = route(turned, edges);
  const placed: Placed = {
    width: wired.size ? arranged.width : 0,
    height: wired.size ? arranged.height : 0,
    boxes: arranged.boxes,
    links: links.map(([from, to], i) => ({ from, to, points: (points[i] ?? []).map(([x, y]) => [y, x]) })),
  };
  const alone = [...sizes].filter(([key]) => !wired.has(key));
  addRows(placed, alone, Math.max(room, placed.width));
  return fit(placed);
}

function turn({ x, y, width, height }: Box): Box {
  return { x: y, y: x, width: height, height: width };
}

function sizeOf({ kind, name, part, members }: Item, measure: (text: string) => number): Size {
  const words = measure(members ? `${name} ${members.length}` : name) + WORDS;
  if (kind === "part") {
    return part?.kind === "widget"
      ? { width: clamp(words + 14, LEAST), height: PLAIN }
      : { width: PART_WIDTH, height: PART };
  }
  if (kind === "topic") return { width: clamp(words + RATE, TOPIC_LEAST), height: TOPIC };
  return { width: clamp(words + (members ? 52 : 0), LEAST), height: NODE };
}

function clamp(width: number, least: number): number {
  return Math.ceil(Math.min(MOST, Math.max(least, width)));
}

/** Adds boxes in rows below, each as high as the highest in it, in columns of one width for similar boxes. */
function addRows(placed: Placed, boxes: (readonly [string, Size])[], room: number): void {
  if (!boxes.length) return;
  const width = Math.max(...boxes.map(([, size]) => size.width));
  const columns = Math.max(1, Math.floor((room + GAP) / (width + GAP)));
  let top = placed.height ? placed.height + 24 : 0;
  for (let i = 0; i < boxes.length; i += columns) {
    const row = boxes.slice(i, i + columns);
    for (const [k, [key, size]] of row.entries())
      placed.boxes.set(key, { ...size, width, x: k * (width + GAP), y: top });
    top += Math.max(...row.map(([, size]) => size.height)) + GAP;
  }
  placed.width = Math.max(placed.width, Math.min(columns, boxes.length) * (width + GAP) - GAP);
  placed.height = top - GAP;
}

/** Moves everything if an arrow leaves the picture, which grows. */
function fit(placed: Placed): Placed {
  const xs = placed.links.flatMap(({ points }) => points.map(([x]) => x));
  const ys = placed.links.flatMap(({ points }) => points.map(([, y]) => y));
  const [left, top] = [Math.max(0, ...xs.map((x) => 2 - x)), Math.max(0, ...ys.map((y) => 2 - y))];
  const [right, bottom] = [
    Math.max(placed.width, ...xs.map((x) => x + 2)),
    Math.max(placed.height, ...ys.map((y) => y + 2)),
  ];
  const move = ({ x, y, ...size }: Box): Box => ({ x: x + left, y: y + top, ...size });
  return {
    width: right + left,
    height: bottom + top,
    boxes: new Map([...placed.boxes].map(([key, box]) => [key, move(box)] as const)),
    links: placed.links.map((link) => ({ ...link, points: link.points.map(([x, y]) => [x + left, y + top]) })),
  };
}

/** The box next to one in a direction; undefined without one. */
export function beside({ boxes }: Placed, key: string, dx: number, dy: number): string | undefined {
  const from = boxes.get(key);
  if (!from) return boxes.keys().next().value;
  const [x, y] = [from.x + from.width / 2, from.y + from.height / 2];
  let [best, least] = [undefined as string | undefined, Infinity];
  for (const [other, box] of boxes) {
    const [ahead, across] = [
      dx * (box.x + box.width / 2 - x) + dy * (box.y + box.height / 2 - y),
      Math.abs(dy * (box.x + box.width / 2 - x)) + Math.abs(dx * (box.y + box.height / 2 - y)),
    ];
    const cost = ahead + 2 * across;
    if (other !== key && ahead > 1 && cost < least) [best, least] = [other, cost];
  }
  return best;
}
