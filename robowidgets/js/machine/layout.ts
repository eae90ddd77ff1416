import type { Box, Size } from "../shared/box.ts";
import { type Arrow, arrange } from "../shared/graph/arrange.ts";
import { route } from "../shared/graph/route.ts";
import { labelOf } from "./step.ts";
import type { MachineOutline, MoveOutline, StateOutline } from "./traits.ts";

export interface PlacedState extends Box {
  machine: MachineOutline;
  state: StateOutline;
  isInitial: boolean;
  /** True if its machines are drawn within. */
  isOpen: boolean;
}

export interface PlacedMove {
  machine: MachineOutline;
  move: MoveOutline;
  /** Corners of the arrow. */
  points: [x: number, y: number][];
  label: Box;
}

/** Places in pixels: outer states and machines come before those within. */
export interface Placed {
  width: number;
  height: number;
  states: PlacedState[];
  moves: PlacedMove[];
  /** Start boxes of moves from any state. */
  any: Box[];
  /** Frames of machines that run side by side. */
  lanes: (Box & { name: string })[];
}

/** The inputs of the layout. */
interface Setting {
  /** Width of a text in the picture. */
  measure(text: string): number;
  /** Width beyond which machines stand below each other instead of side by side. */
  room: number;
  /** Returns true if the machines within a state are drawn. */
  isOpen(state: StateOutline, machine: MachineOutline): boolean;
}

export const ANY = "*";
const STATE_HEIGHT = 32;
const TIMED_HEIGHT = 44;
const RING_WIDTH = 76;
const PADDING = 12;
const HEAD = 30;
const GAP = 14;
/** Room for the dot and the arrow before an initial state. */
const START = 24;
/** From a state to the words of a move that leads back to it. */
const BESIDE_LOOP = 18;
const NUMBERS_WIDTH = 104;
const DOT_WIDTH = 16;
const DEEPEST = 3;
const GAPS = { rankdir: "TB", nodesep: 18, edgesep: 14, ranksep: 44 } as const;

/**
 * Places machines that run side by side, with everything within. Moves never leave their machine: each is laid out
 * alone.
 */
export function place(machines: MachineOutline[], setting: Setting, depth = 1): Placed {
  const parts = machines.map((machine) => placeMachine(machine, setting, depth));
  const [only] = parts;
  if (parts.length === 1 && only) return only;
  const all: Placed = { width: 0, height: 0, states: [], moves: [], any: [], lanes: [] };
  const isRow = parts.reduce((sum, { width }) => sum + width + 2 * PADDING + GAP, -GAP) <= setting.room;
  for (const [i, part] of parts.entries()) {
    const name = machines[i]?.path.split(".").at(-1) ?? "";
    const width = Math.max(part.width, setting.measure(name)) + 2 * PADDING;
    const lane = { x: 0, y: 0, width, height: part.height + HEAD + PADDING, name };
    if (isRow) lane.x = all.width && all.width + GAP;
    else lane.y = all.height && all.height + GAP;
    all.lanes.push(lane);
    addTo(all, part, lane.x + (width - part.width) / 2, lane.y + HEAD);
    all.width = Math.max(all.width, lane.x + width);
    all.height = Math.max(all.height, lane.y + lane.height);
  }
  return all;
}

/** Returns true if a state is timed: it has a ring. */
export function isTimed(machine: MachineOutline, state: StateOutline): boolean {
  return machine.moves.some(({ source, after }) => after !== null && source === state.name);
}

function placeMachine(machine: MachineOutline, setting: Setting, depth: number): Placed {
  const sizes = new Map<string, Size>();
  const inner = new Map<string, Placed>();
  for (const [i, state] of machine.states.entries()) {
    const timed = isTimed(machine, state);
    const name = setting.measure(state.name) + 2 * PADDING + (timed ? RING_WIDTH : 0);
    const size = { width: Math.max(72, name), height: timed ? TIMED_HEIGHT : STATE_HEIGHT };
    if (state.machines.length && depth <= DEEPEST && setting.isOpen(state, machine)) {
      const within = place(state.machines, setting, depth + 1);
      inner.set(state.name, within);
      size.width = Math.max(size.width, within.width + 2 * PADDING);
      size.height = HEAD + within.height + PADDING + (timed ? TIMED_HEIGHT - STATE_HEIGHT : 0);
    } else if (state.machines.length) size.height = TIMED_HEIGHT;
    sizes.set(state.name, { width: size.width + (i ? 0 : 2 * START), height: size.height });
  }
  if (machine.moves.some(({ source }) => source === ANY)) sizes.set(ANY, { width: 76, height: 22 });
  const arrows = machine.moves.map((move): Arrow => {
    const { source, target } = move;
    const isLoop = source === target;
    const words = setting.measure(labelOf(move)) + (move.event ? DOT_WIDTH : 0);
    const width = Math.max(words, move.compares ? NUMBERS_WIDTH : 0) + (isLoop ? BESIDE_LOOP : 0);
    const height = move.compares ? 32 : 18;
    return { source, target, width, height, labelpos: isLoop ? "c" : "r", labeloffset: 7 };
  });
  const { width, height, boxes, edges } = arrange(sizes, arrows, GAPS);
  const placed: Placed = { width, height, states: [], moves: [], any: [], lanes: [] };
  const first = boxes.get(machine.states[0]?.name ?? "");
  if (first) Object.assign(first, { x: first.x + START, width: first.width - 2 * START });
  for (const [i, state] of machine.states.entries()) {
    const box = boxes.get(state.name) as Box;
    const within = inner.get(state.name);
    placed.states.push({ ...box, machine, state, isInitial: i === 0, isOpen: within !== undefined });
    if (within)
      addTo(placed, within, box.x + (box.width - within.width) / 2, box.y + box.height - PADDING - within.height);
  }
  const any = boxes.get(ANY);
  if (any) placed.any.push(any);
  /** Right end of the words of the last loop of a state; the room that dagre leaves for them may begin far from it. */
  const loops = new Map<string, number>();
  for (const { source, target, label } of edges) {
    if (source !== target) continue;
    const box = boxes.get(source) as Box;
    label.x = (loops.get(source) ?? box.x + box.width) + BESIDE_LOOP;
    label.width -= BESIDE_LOOP;
    loops.set(source, label.x + label.width);
  }
  const routes = route(boxes, edges);
  for (const [i, move] of machine.moves.entries()) {
    const { label } = edges[i] as { label: Box };
    placed.moves.push({ machine, move, label, points: routes[i] ?? [] });
  }
  return fit(placed);
}

/** Moves everything to the right if an arrow lies left of the picture, and grows the picture to hold everything. */
function fit(placed: Placed): Placed {
  const edges = placed.moves.flatMap(({ points, label }) => [
    ...points.map(([x]) => x),
    label.x,
    label.x + label.width,
  ]);
  const left = Math.max(0, ...edges.map((x) => 2 - x));
  const width = Math.max(placed.width, ...edges.map((x) => x + 2)) + left;
  const fitted: Placed = { width, height: placed.height, states: [], moves: [], any: [], lanes: [] };
  addTo(fitted, placed, left, 0);
  return fitted;
}

function addTo(all: Placed, part: Placed, dx: number, dy: number): void {
  const shift = <B extends Box>(box: B): B => ({ ...box, x: box.x + dx, y: box.y + dy });
  all.states.push(...part.states.map(shift));
  all.any.push(...part.any.map(shift));
  all.lanes.push(...part.lanes.map(shift));
  for (const move of part.moves) {
    const points = move.points.map(([x, y]): [number, number] => [x + dx, y + dy]);
    all.moves.push({ ...move, points, label: shift(move.label) });
  }
}
