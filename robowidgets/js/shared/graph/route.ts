import type { Box, Point } from "../box.ts";

/** An arrow between two boxes, with the places that dagre left free for it, one in each row that it passes. */
export interface Edge {
  source: string;
  target: string;
  via: Point[];
  label: Box;
}

/** Distance between two arrows at one side of a box. */
const PORT = 22;
const LOOP = 12;

/**
 * The corners of arrows of horizontal and vertical lines. They run vertically where dagre has left room, and
 * horizontally only between its rows, each at a separate height. So they cross no box and no label.
 */
export function route(boxes: Map<string, Box>, edges: Edge[]): [x: number, y: number][][] {
  const middle = (name: string): Point => {
    const { x, y, width, height } = boxes.get(name) as Box;
    return { x: x + width / 2, y: y + height / 2 };
  };
  const rows = rowsOf([...boxes.values(), ...edges.map(({ label }) => label)], edges);
  const ways = edges.map(({ source, target, via }) => [middle(source), ...via, middle(target)]);
  spread(boxes, edges, ways);
  const jogs = ways.flatMap((way, edge) => {
    if (edges[edge]?.source === edges[edge]?.target) return [];
    return way.slice(1).flatMap(({ x, y }, i) => {
      const from = way[i] as Point;
      const upper = rowAt(rows, Math.min(from.y, y));
      return from.x === x ? [] : [{ edge, i, upper, low: Math.min(from.x, x), high: Math.max(from.x, x) }];
    });
  });
  const heights = new Map<string, number>();
  for (const [upper, row] of rows.entries()) {
    const below = rows[upper + 1];
    const here = jogs.filter((jog) => jog.upper === upper).sort((a, b) => a.low - b.low);
    if (!below || !here.length) continue;
    const lanes: number[] = [];
    const laneOf = here.map(({ low, high }) => {
      const free = lanes.findIndex((end) => end + 8 < low);
      const lane = free < 0 ? lanes.length : free;
      lanes[lane] = high;
      return lane;
    });
    const [top, bottom] = [row.y + row.half, below.y - below.half];
    for (const [k, { edge, i }] of here.entries()) {
      heights.set(`${edge} ${i}`, top + (((laneOf[k] as number) + 1) * (bottom - top)) / (lanes.length + 1));
    }
  }
  return ways.map((way, edge) => {
    const { source, target } = edges[edge] as Edge;
    const box = boxes.get(target) as Box;
    if (source === target) return loop(box);
    const [start, end] = [way[0] as Point, way.at(-1) as Point];
    const from = boxes.get(source) as Box;
    const isDown = start.y < end.y;
    const corners: [number, number][] = [[start.x, isDown ? from.y + from.height : from.y]];
    for (const [i, { x }] of way.slice(1).entries()) {
      const y = heights.get(`${edge} ${i}`);
      if (y !== undefined) corners.push([(way[i] as Point).x, y], [x, y]);
    }
    corners.push([end.x, isDown ? box.y : box.y + box.height]);
    return corners;
  });
}

/** The rows of dagre from the top: their middles, and half the heights of their contents. */
function rowsOf(boxes: Box[], edges: Edge[]): { y: number; half: number }[] {
  const halves = new Map<number, number>();
  const grow = (y: number, half: number) => {
    const key = Math.round(y);
    halves.set(key, Math.max(halves.get(key) ?? 0, half));
  };
  for (const { y, height } of boxes) grow(y + height / 2, height / 2);
  for (const { via } of edges) for (const { y } of via) grow(y, 0);
  return [...halves].map(([y, half]) => ({ y, half })).sort((a, b) => a.y - b.y);
}

function rowAt(rows: { y: number }[], y: number): number {
  return rows.findIndex((row) => Math.abs(row.y - y) <= 1);
}

/** Spreads the ends of arrows that share a side of a box about its middle, in the order of their other ends. */
function spread(boxes: Map<string, Box>, edges: Edge[], ways: Point[][]): void {
  const sides = new Map<string, { way: Point[]; end: number; toward: number; box: Box }[]>();
  for (const [i, { source, target }] of edges.entries()) {
    const way = ways[i] as Point[];
    const isDown = (way[0] as Point).y < (way.at(-1) as Point).y;
    if (source === target) continue;
    for (const [name, end, toward] of [
      [source, 0, 1],
      [target, way.length - 1, way.length - 2],
    ] as const) {
      const side = `${name} ${(end === 0) === isDown ? "bottom" : "top"}`;
      const ends = sides.get(side) ?? [];
      sides.set(side, ends);
      ends.push({ way, end, toward: (way[toward] as Point).x, box: boxes.get(name) as Box });
    }
  }
  for (const ends of sides.values()) {
    ends.sort((a, b) => a.toward - b.toward);
    for (const [k, { way, end, toward, box }] of ends.entries()) {
      const step = Math.min(PORT, box.width / (ends.length + 1));
      const x = box.x + box.width / 2 + (k - (ends.length - 1) / 2) * step;
      // A line that may go straight on does so, if it is alone at its side.
      const isStraight = ends.length === 1 && Math.abs(toward - x) < box.width / 2 - 8;
      way[end] = { x: isStraight ? toward : x, y: (way[end] as Point).y };
    }
  }
}

function loop({ x, y, width, height }: Box): [number, number][] {
  const [right, middle] = [x + width, y + height / 2];
  return [
    [right, middle - 6],
    [right + LOOP, middle - 6],
    [right + LOOP, middle + 6],
    [right, middle + 6],
  ];
}
