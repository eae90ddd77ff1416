import { makeSvg } from "../shared/dom.ts";
import type { Sensor } from "../shared/frames/touch.ts";
import type { Around, Lead } from "./around.ts";

const HALF_ARC = 0.16;

/** The outline of a robot's body from above, the places of its sensors on it, and the lines to their rectangles. */
export class Body {
  readonly element = makeSvg("svg", { class: "rw-body", "aria-hidden": "true" });

  draw({ center, radius, leads, height }: Around, width: number, sensors: Sensor[]): void {
    const states = new Map(sensors.map(({ name, state }) => [name, state]));
    this.element.setAttribute("width", String(width));
    this.element.setAttribute("height", String(height));
    const circle = shape("circle", "rw-body-outline", { cx: center.x, cy: center.y, r: radius });
    const size = radius * 0.22;
    const { x, y } = center;
    const heading = shape("path", "rw-body-heading", {
      d: `M${x} ${y - 1.4 * size} L${x + size} ${y + size} L${x} ${y + 0.45 * size} L${x - size} ${y + size} Z`,
    });
    const lines = leads.map(({ name, from, to }) =>
      shape("line", "rw-body-lead", { x1: from.x, y1: from.y, x2: to.x, y2: to.y }, states.get(name)),
    );
    const marks = leads.map((lead) =>
      shape("path", "rw-body-mark", { d: arc(lead, center, radius) }, states.get(lead.name)),
    );
    this.element.replaceChildren(circle, heading, ...lines, ...marks);
  }
}

/** The part of the outline around the place of a sensor. */
function arc({ angle }: Lead, center: { x: number; y: number }, radius: number): string {
  const at = (turn: number) =>
    `${center.x - radius * Math.sin(angle + turn)} ${center.y - radius * Math.cos(angle + turn)}`;
  return `M${at(HALF_ARC)} A${radius} ${radius} 0 0 1 ${at(-HALF_ARC)}`;
}

function shape(tag: string, className: string, attributes: Record<string, number | string>, state = ""): SVGElement {
  return makeSvg(tag, { class: className, ...(state && { "data-state": state }), ...attributes });
}
