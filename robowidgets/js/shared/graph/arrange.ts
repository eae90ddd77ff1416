import dagre from "@dagrejs/dagre";
import type { Box, Point, Size } from "../box.ts";
import type { Edge } from "./route.ts";

/** An arrow to be placed, from one box to another, with the room for its words. */
export interface Arrow extends Partial<Size> {
  source: string;
  target: string;
  labelpos?: "c" | "r";
  labeloffset?: number;
}

/** Gaps between boxes of a row, between arrows, and between rows; and the direction of rows. */
interface Gaps {
  nodesep: number;
  edgesep: number;
  ranksep: number;
  rankdir: "TB" | "LR";
}

/** Places of boxes by their names, and for each arrow, in its order, the input of `route`. */
export interface Arranged extends Size {
  boxes: Map<string, Box>;
  edges: Edge[];
}

/** Places boxes in rows by dagre, so that arrows lead on from row to row. */
export function arrange(sizes: Map<string, Size>, arrows: Arrow[], gaps: Gaps): Arranged {
  const graph = new dagre.graphlib.Graph({ multigraph: true });
  graph.setGraph({ ...gaps });
  for (const [name, { width, height }] of sizes) graph.setNode(name, { width, height });
  for (const [i, { source, target, ...label }] of arrows.entries()) {
    graph.setEdge(source, target, { width: 0, height: 0, ...label }, String(i));
  }
  dagre.layout(graph);
  const { width = 0, height = 0 } = graph.graph();
  const boxes = new Map([...sizes.keys()].map((name) => [name, boxOf(graph.node(name))] as const));
  const edges = arrows.map(({ source, target }, i) => {
    const { points = [], x = 0, y = 0, width = 0, height = 0 } = graph.edge(source, target, String(i));
    const via: Point[] = source === target ? [] : points.slice(1, -1);
    return { source, target, via, label: boxOf({ x, y, width, height }) };
  });
  return { width, height, boxes, edges };
}

/** The box about a middle. */
function boxOf({ x, y, width, height }: Box): Box {
  return { x: x - width / 2, y: y - height / 2, width, height };
}
