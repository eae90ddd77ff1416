import { isMoving, rest, type Situation, type Text, toStopText, warn } from "../shared/driving/text.ts";
import type { State } from "./press.ts";

/** The drivers without a hand. */
const DRIVERS: Partial<Record<string, string>> = { program: "a program", assistant: "an assistant" };
const AGAIN = "let go and press again";

/** The texts of a pad whose press is in a state. */
export function toText(situation: Situation, lease: { state: State; press: string }, enabled: boolean): Text {
  const stop = toStopText(situation);
  if (stop) return stop;
  const { told, hears } = situation;
  const { state } = lease;
  const other = DRIVERS[told.driver];
  const isProgram = other !== undefined;
  const now = isProgram ? `${other} drives` : isMoving(told) ? "stopping" : "stopped";
  const then = isProgram ? `; ${now}` : `: ${now}`;
  if (state === "driving") return { text: "driving", hint: "", kind: "drive" };
  if (state === "silent") return warn(`kernel busy${then}`, "it does not answer");
  if (state === "late") return warn(`no answer in time${then}`, AGAIN);
  if (state === "failed") return warn(told.cause, AGAIN);
  if (state === "hangs") return warn("the robot's program hangs", "the function that drives it has not returned");
  if (state === "taken") return rest("driven from another pad", AGAIN);
  if (state === "released") return rest(isProgram ? now : "stopped by the program", AGAIN);
  if (!told.ready)
    return rest(told.cause || "no feed", told.cause ? "open it and connect again" : "nothing to drive yet");
  if (!enabled) return rest("switched off");
  if (state === "asking") return rest("asking the kernel");
  if (isProgram) return rest(now, "press to take over");
  if (told.driver && told.driver !== lease.press) return rest("driven from another pad");
  if (state === "stopped") return rest(now, AGAIN);
  return rest(now, hears ? "drag, or arrow keys" : "the kernel is busy");
}
