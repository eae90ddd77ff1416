import type { Box } from "../shared/box.ts";
import { makeButton, set, setHidden, setText } from "../shared/dom.ts";
import { LaidOut } from "../shared/laid_out.ts";
import { type Model, setTraits } from "../shared/model.ts";
import type { About, Mount } from "../shared/traits.ts";
import type { LaserTraits } from "./traits.ts";

/** Converts radians of the robot to the angle on show: of the robot, or of the scanner. */
export type ToShown = (angle: number) => number;

/** Radians by which the scanner's forward is turned from the robot's, as the angles of a scan have it. */
export function turnOf({ yaw = 0, turns = 0 }: Mount): number {
  return yaw - 2 * Math.PI * turns;
}

/** An angle of the robot as one of the scanner; Python has the same. */
export function toScanner(mount: Mount, angle: number): number {
  const own = angle - turnOf(mount);
  return mount.upside_down ? -own : own;
}

/** The conversion to the angles on show. */
export function shownBy(model: Model<LaserTraits>, { mount, angle_offset = 0 }: About): ToShown {
  if (!mount || !model.get("own_angles")) return (angle) => angle;
  return (angle) => toScanner(mount, angle - angle_offset);
}

/** Pixels from the edges of the picture. */
const EDGE = 8;

/** A button in a corner of the picture: it shows the mount of the scanner, and switches to its own angles and back. */
export class MountButton {
  readonly element: HTMLButtonElement;
  readonly #model: Model<LaserTraits>;
  readonly #size: LaidOut;
  #top = EDGE;

  constructor(model: Model<LaserTraits>, redraw: () => void, signal: AbortSignal) {
    this.#model = model;
    const toggle = () => setTraits(model, { own_angles: !model.get("own_angles") });
    this.element = makeButton("rw-mount rw-over", "", toggle, signal, "");
    // Its accessible name is its text.
    this.element.ariaLabel = null;
    this.element.hidden = true;
    this.#size = new LaidOut(redraw, signal).of(this.element);
  }

  /** Places it below a notice; returns the boxes that it covers. */
  place({ mount }: About, noticeHeight: number): Box[] {
    this.#top = noticeHeight + EDGE;
    return mount ? [{ x: EDGE, y: this.#top, width: this.#size.width, height: this.#size.height }] : [];
  }

  update({ mount }: About): void {
    const isOwn = this.#model.get("own_angles");
    setHidden(this.element, !mount);
    if (!mount) return;
    const words = mount.words.replaceAll("-", "\u2212");
    setText(this.element, isOwn ? "scanner\u2019s own angles" : words);
    set(this.element, "ariaPressed", String(isOwn));
    const whose = isOwn
      ? "the scanner\u2019s own. Show the robot\u2019s"
      : "the robot\u2019s. Show the scanner\u2019s own";
    set(this.element, "title", `The scanner is ${words}. Angles are ${whose} (a)`);
    const top = `${this.#top}px`;
    if (this.element.style.top !== top) this.element.style.top = top;
  }
}
