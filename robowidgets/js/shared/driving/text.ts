import { toFixed } from "../format.ts";
import { NO_KERNEL } from "../model.ts";
import type { Note, StopControl } from "./control.ts";
import type { Told } from "./traits.ts";

/** A text for the status line, and true for a warning. */
export interface Text {
  text: string;
  /** A hint for the user. */
  hint: string;
  kind: "rest" | "drive" | "warn";
}

/** The inputs of the status. */
export type Situation = Pick<StopControl, "told" | "note" | "hasKernel" | "hears" | "silence" | "canInterrupt">;

export const rest = (text: string, hint = ""): Text => ({ text, hint, kind: "rest" });
export const warn = (text: string, hint = ""): Text => ({ text, hint, kind: "warn" });

const HELP =
  "Interrupt the cell with the notebook's own button. " +
  "ipykernel 7 or later hears Stop beside a running cell in JupyterLab; a robot should also stop by itself.";

const NOTES: Partial<Record<Note, Text>> = {
  unreachable: warn("Stop cannot reach the busy kernel", HELP),
  ignored: warn(
    "the kernel was interrupted, but does not answer",
    "its cell goes on, or the connection is lost: press Stop again, or restart the kernel",
  ),
};

/** The status of Stop, which comes before any other; null without one. */
export function toStopText({ told, note, hasKernel, hears, silence }: Situation): Text | null {
  if (!hasKernel) return warn(NO_KERNEL, "Stop reaches nothing; what the robot does is not known");
  const failed = told.stopped ? undefined : NOTES[note];
  if (failed) return failed;
  if (silence) return warn(silence, "what the robot does is not known");
  if (!told.stopped && note === "asking") return rest("stopping");
  if (!told.stopped && note === "interrupted") return rest("stopping", "the kernel was interrupted");
  if (!told.stopped) return null;
  if (isMoving(told)) return rest("stopping");
  if (note === "interrupted") return rest("nobody may drive", "the kernel was interrupted");
  if (note === "refused") return rest("nobody may drive", "Allow came too late: press it again");
  return rest("nobody may drive", hears ? "until it is allowed again" : "the kernel is busy");
}

/** The status of driving: its source and the speed. */
export function toDriverText(situation: Situation): Text {
  const { told, hears, canInterrupt } = situation;
  const stop = toStopText(situation);
  if (stop) return stop;
  const busy = `kernel busy: Stop ${canInterrupt ? "interrupts the cell" : "cannot reach it"}`;
  const hint = hears ? told.status || "Escape here stops, too" : busy;
  if (!told.ready) return rest(told.cause || "no feed", hint);
  const topic = told.topic && ` ${told.topic}`;
  if (told.driver === "program") return { text: `a program drives${topic}: ${toSpeed(told)}`, hint, kind: "drive" };
  if (told.driver === "assistant")
    return { text: `an assistant drives${topic}: ${toSpeed(told)}, ${told.left}\u00A0s left`, hint, kind: "drive" };
  if (told.driver) return { text: `a hand drives${topic} from a pad: ${toSpeed(told)}`, hint, kind: "drive" };
  return rest(isMoving(told) ? "stopping" : told.idle || "nobody drives", hint);
}

/** Returns true if the speed that was sent last is not zero. */
export function isMoving({ speed }: Told): boolean {
  return speed.some((value) => value !== 0);
}

/** Start and width of a bar from zero to a value, as parts of a track from -limit to limit. */
export function toBar(value: number, limit: number): { left: string; width: string } {
  const share = Math.max(-1, Math.min(1, value / limit)) * 50;
  return { left: `${50 + Math.min(0, share)}%`, width: `${Math.abs(share)}%` };
}

function toSpeed({ speed: [linear, angular, lateral] }: Told): string {
  const side = lateral > 0 ? "left" : "right";
  const sideways = lateral ? `${toFixed(Math.abs(lateral), 2)} m/s to the ${side}, ` : "";
  return `${toFixed(linear, 2)} m/s, ${sideways}${toFixed(angular, 2)} rad/s`.replaceAll(" ", "\u00A0");
}
