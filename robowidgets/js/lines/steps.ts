import { Reader } from "../shared/bytes.ts";
import { type Frame, readHead } from "../shared/stream.ts";

/** The newest step, with some of those since the frame before. */
export interface Steps extends Frame {
  /** The version that made them. */
  key: string;
  /** Oldest first; the last one is the newest. */
  steps: Step[];
  /** Number of steps of the version so far. */
  total: number;
  /** For each line of each function, the number of steps in which it was reached, and in which it was true. */
  totals: Record<string, [line: number, reached: number, true_: number][]>;
}

export interface Step {
  number: number;
  /** Seconds of the program. */
  time: number;
  /** Seconds of Python's monotonic clock. */
  at: number;
  /** The names and texts of its arguments. */
  given: [name: string, text: string][];
  calls: Call[];
  /** True if it returned None. */
  none: boolean;
}

/** A call of a function. */
export interface Call {
  key: string;
  lines: Line[];
  loops: [line: number, rows: string[], times: number][];
  error: [line: number, text: string] | null;
}

/** A line that was reached. */
export type Line = [
  number: number,
  value: string,
  details: string[],
  times: number,
  kind: "number" | "flag" | "reached",
  level: number | null,
  rays: [runs: number[], nearest: number, frame: string][],
];

/** A frame of Python: the head, then JSON. */
export function decodeSteps(bytes: DataView): Steps {
  const reader = new Reader(bytes);
  const head = readHead(reader);
  return { ...JSON.parse(new TextDecoder().decode(reader.bytes(reader.left))), ...head };
}

/** The times and levels of the steps of a line, oldest first. The level is null if the line was not reached. */
export type Trace = [at: number, level: number | null][];

/** The traces of all lines of a version, by function and line, since a time. */
export function tracesOf(frames: Iterable<Steps>, key: string, since: number): Map<string, Trace> {
  const traces = new Map<string, Trace>();
  /** The number of the last step of each trace. */
  const last = new Map<string, number>();
  let count = 0;
  for (const frame of frames) {
    if (frame.key !== key) continue;
    for (const step of frame.steps) {
      if (step.at < since) continue;
      for (const call of step.calls) {
        for (const [number, , , , , level] of call.lines) {
          const name = `${call.key}:${number}`;
          const trace = traces.get(name) ?? [];
          // Steps in which it was not reached are a gap.
          if ((last.get(name) ?? count) < count - 1) trace.push([step.at, null]);
          trace.push([step.at, level]);
          last.set(name, count);
          traces.set(name, trace);
        }
      }
      count++;
    }
  }
  return traces;
}
