import type { State } from "./grip.ts";

/** What the words on the pad depend on. */
export interface Situation {
  state: State;
  /** Whether there is something to drive. */
  ready: boolean;
  enabled: boolean;
  /** Whether another pad or page drives. */
  elsewhere: boolean;
  /** Why a press ended, or nothing can be driven any more. */
  cause: string;
}

/** What is going on, in words, and whether it is a warning. */
export interface Words {
  text: string;
  /** What a person can do. */
  hint: string;
  kind: "rest" | "drive" | "warn";
}

const AGAIN = "let go and press again";

export function toWords({ state, ready, enabled, elsewhere, cause }: Situation): Words {
  const rest = (text: string, hint = ""): Words => ({ text, hint, kind: "rest" });
  const warn = (text: string, hint = ""): Words => ({ text, hint, kind: "warn" });
  if (state === "driving") return { text: "driving", hint: "", kind: "drive" };
  if (state === "silent") return warn("kernel busy: stopped", "it does not answer");
  if (state === "late") return warn("no answer in time: stopped", AGAIN);
  if (state === "failed") return warn(cause, AGAIN);
  if (state === "hangs") return warn("the robot's program hangs", "what drives it has not come back");
  if (state === "taken") return rest("driven from another pad", AGAIN);
  if (!ready) return cause ? rest(cause, "open it and connect again") : rest("no feed", "nothing to drive yet");
  if (!enabled) return rest("switched off");
  if (state === "asking") return rest("asking the kernel");
  if (elsewhere) return rest("driven from another pad");
  return rest("stopped", "drag, or arrow keys");
}
