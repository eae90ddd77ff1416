import type { Situation } from "../../robowidgets/js/shared/driving/text.ts";
import type { Told } from "../../robowidgets/js/shared/driving/traits.ts";

/** A message of Python about a robot that stands still, with the given changes. */
export function told(more: Partial<Told> = {}): Told {
  return {
    ready: true,
    driver: "",
    speed: [0, 0, 0],
    stopped: false,
    error: "",
    cause: "",
    status: "",
    topic: "/cmd_vel",
    number: 0,
    ...more,
  };
}

/** The situation of a robot that stands still and a kernel that answers, with the given changes to its state. */
export function situation(more: Partial<Told> = {}): Situation {
  return { told: told(more), note: "", hasKernel: true, hears: true, silence: "", canInterrupt: true };
}
