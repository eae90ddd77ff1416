import { Reader } from "../shared/bytes.ts";
import { type Frame, readHead } from "../shared/stream.ts";
import type { Fired, MachineOutline, MoveOutline, StateOutline } from "./traits.ts";

/** The result of a step of a machine. */
export interface Step extends Frame {
  /** The version that made it. */
  key: string;
  /** Seconds since the first step. */
  time: number;
  /** By path of a machine: its active state, and when it was entered. */
  states: Record<string, [name: string, entered: number]>;
  /** The values of events in this step; null for unknown. */
  judged: [machine: string, event: string, value: boolean | null, text: string][];
  /** Durations of time-outs, including durations that a variable sets. */
  seconds: [machine: string, after: string, seconds: number][];
}

/** A frame of Python: the head, then JSON. */
export function decodeStep(bytes: DataView): Step {
  const reader = new Reader(bytes);
  const head = readHead(reader);
  return { ...JSON.parse(new TextDecoder().decode(reader.bytes(reader.left))), ...head };
}

export function isActive(machine: MachineOutline, state: StateOutline, step: Step): boolean {
  return step.states[machine.path]?.[0] === state.name;
}

/** The active states, inner ones behind outer ones: "avoid › turn + look". */
export function activeText(machines: MachineOutline[], step: Step): string {
  const parts = machines.flatMap((machine) => {
    const state = machine.states.find((one) => isActive(machine, one, step));
    if (!state) return [];
    return [[state.name, activeText(state.machines, step)].filter(Boolean).join(" \u203a ")];
  });
  return parts.join(" + ");
}

/** The value of the event of a move in the step: "unknown" also if it was not judged. */
export function verdictOf(machine: MachineOutline, { event }: MoveOutline, step: Step): [state: string, text: string] {
  const found = step.judged.find(([path, name]) => path === machine.path && name === event);
  return found ? [String(found[2] ?? "unknown"), found[3]] : ["unknown", ""];
}

/** Seconds until the next time-out of an active state, and its duration; null without a time-out. */
export function timeLeft(machine: MachineOutline, state: StateOutline, step: Step): [left: number, of: number] | null {
  if (!isActive(machine, state, step)) return null;
  const passed = step.time - (step.states[machine.path]?.[1] ?? step.time);
  const all = machine.moves.flatMap(({ source, after }) => {
    if (after === null || source !== state.name) return [];
    const known = step.seconds.find(([path, text]) => path === machine.path && text === after);
    return [known?.[2] ?? Number(after)].filter(Number.isFinite);
  });
  return all.length ? [Math.max(0, Math.min(...all) - passed), Math.min(...all)] : null;
}

/** Returns true if a move led its machine to its active state. */
export function isTaken(machine: MachineOutline, move: MoveOutline, fired: Fired[], step: Step): boolean {
  const last = fired.filter((one) => one.machine === machine.path && one.time <= step.time).at(-1);
  return (
    last !== undefined &&
    last.target === step.states[machine.path]?.[0] &&
    last.target === move.target &&
    (move.source === last.source || move.source === "*") &&
    last.why === move.why
  );
}

/** The words on an arrow. */
export function labelOf({ event, after, why }: MoveOutline): string {
  return event ?? (Number.isFinite(Number(after ?? NaN)) ? `${why} s` : why);
}
