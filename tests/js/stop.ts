import type { Situation } from "../../robowidgets/js/shared/driving/text.ts";
import type { Told } from "../../robowidgets/js/shared/driving/traits.ts";

/** What Python tells of a robot that nobody drives, but for what is given. */
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

/** How a robot that nobody drives stands with a kernel that answers, but for what is told. */
export function situation(more: Partial<Told> = {}): Situation {
  return { told: told(more), note: "", hasKernel: true, hears: true, silence: "", canInterrupt: true };
}
