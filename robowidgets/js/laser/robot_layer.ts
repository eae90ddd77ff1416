import type { Point } from "../shared/box.ts";
import { write } from "../shared/canvas.ts";
import { toFixed } from "../shared/format.ts";
import { decodeSpeeds, type Speeds } from "../shared/frames/speeds.ts";
import { decodeTouch, type Touch } from "../shared/frames/touch.ts";
import { onChange } from "../shared/model.ts";
import { toPixel } from "../shared/projection.ts";
import { type Theme, textFont } from "../shared/theme.ts";
import { Companion } from "./companion.ts";
import { drawRobot } from "./draw_area.ts";
import { asSeen, atLeast, type Footprint, outlineOf, partOf, speedAt, touchesAt, wayOf } from "./footprint.ts";
import { type Depth, type Host, isFree, type Layer, type Painter, type Stage } from "./layer.ts";

/** Pixels across below which the robot is drawn larger than to scale: it holds the arrow head. */
const LEAST = 26;
/** Pixels from the outline to the middle of a bumper. */
const OUTSIDE = 4;

/** The robot to scale, if enabled, with its bumpers and its path in the next two seconds. */
export class RobotLayer implements Layer {
  readonly traits = ["_robot"] as const;
  readonly #host: Host;
  readonly #speed: Companion<Speeds>;
  readonly #touch: Companion<Touch>;
  readonly #painters: Partial<Record<Depth, Painter>> = {
    guides: (context, stage, theme) => this.#drawOutline(context, stage, theme),
    robot: (context, stage, theme) => this.#drawBumpers(context, stage, theme),
    words: (context, stage, theme) => this.#drawSpeed(context, stage, theme),
  };

  constructor(host: Host) {
    const { model, signal } = host;
    const { redraw } = host.card;
    this.#host = host;
    this.#speed = new Companion(model, decodeSpeeds, redraw, signal);
    this.#touch = new Companion(model, decodeTouch, redraw, signal);
    const follow = () => {
      const { speed = "", touch = "" } = model.get("_robot");
      this.#speed.follow(speed);
      this.#touch.follow(touch);
    };
    onChange(model, ["_robot"], follow, signal);
    follow();
  }

  painters(): Partial<Record<Depth, Painter>> {
    return this.#footprint ? this.#painters : {};
  }

  lowerKey(): unknown {
    return this.#footprint;
  }

  get #footprint(): Footprint | null {
    const robot = this.#host.model.get("_robot");
    return robot.polygon ? (robot as Footprint) : null;
  }

  #robotOn({ projection }: Stage): Footprint | null {
    const robot = this.#footprint;
    return robot && atLeast(robot, (LEAST * projection.viewRange) / projection.radius);
  }

  #drawOutline(context: CanvasRenderingContext2D, stage: Stage, theme: Theme): void {
    const robot = this.#robotOn(stage);
    if (!robot) return;
    trace(context, stage, robot, outlineOf(robot));
    context.closePath();
    context.fillStyle = theme.background;
    context.fill();
    context.strokeStyle = theme.ink;
    context.lineWidth = 1.5;
    context.stroke();
    drawRobot(context, stage.projection, theme);
  }

  #drawBumpers(context: CanvasRenderingContext2D, stage: Stage, theme: Theme): void {
    const robot = this.#robotOn(stage);
    if (!robot) return;
    const states = touchesAt(stage.scan, this.#touch.shown);
    for (const [name, sector] of Object.entries(robot.bumpers)) {
      const state = states.get(name) ?? "unknown";
      trace(context, stage, robot, partOf(robot, sector), OUTSIDE);
      context.strokeStyle = state === "touched" ? theme.touch : theme.guide;
      context.lineWidth = state === "touched" ? 5.5 : 2.5;
      context.setLineDash(state === "unknown" ? [3, 3] : []);
      context.stroke();
      context.setLineDash([]);
    }
    for (const { x, y } of outlineOf(robot).map((place) => pixelOf(stage, robot, place))) stage.occupied.mark(x, y);
    const [vx = NaN, vy = NaN, , , , turn = NaN] = speedAt(stage.scan, this.#speed.shown) ?? [];
    const way = wayOf(robot, vx || 0, vy || 0, turn || 0).map((place) => pixelOf(stage, robot, place));
    if (way.length) drawArrow(context, way, theme);
    for (const { x, y } of way) stage.occupied.mark(x, y);
  }

  /** Writes the speed below the robot, if the place is free. */
  #drawSpeed(context: CanvasRenderingContext2D, stage: Stage, theme: Theme): void {
    const robot = this.#robotOn(stage);
    const [vx = NaN, vy = 0] = speedAt(stage.scan, this.#speed.shown) ?? [];
    if (!robot || Number.isNaN(vx)) return;
    const text = `${toFixed(Math.hypot(vx, vy || 0), 2)} m/s`;
    const font = textFont(theme);
    context.font = font;
    const width = context.measureText(text).width + 6;
    const outline = outlineOf(robot).map((place) => pixelOf(stage, robot, place, OUTSIDE));
    const [x, bottom] = [stage.projection.centerX, Math.max(...outline.map((point) => point.y)) + 3];
    const box = { x: x - width / 2, y: bottom, width, height: 15 };
    if (!isFree(stage, box)) return;
    stage.labels.push(box);
    write(context, text, x, bottom + 8, theme.muted, font, "center", theme.area);
  }
}

/** A place on the robot in the picture, some pixels farther from its middle. */
function pixelOf({ projection }: Pick<Stage, "projection">, robot: Footprint, place: Point, outwards = 0): Point {
  const metres = (outwards * projection.viewRange) / projection.radius;
  const factor = 1 + metres / Math.max(1e-6, Math.hypot(place.x, place.y));
  const seen = asSeen(robot, { x: place.x * factor, y: place.y * factor });
  return toPixel(projection, seen.range, seen.angle);
}

function trace(context: CanvasRenderingContext2D, stage: Stage, robot: Footprint, places: Point[], outwards = 0): void {
  context.beginPath();
  for (const place of places) {
    const { x, y } = pixelOf(stage, robot, place, outwards);
    context.lineTo(x, y);
  }
}

/** A line with a head at its end. */
function drawArrow(context: CanvasRenderingContext2D, way: Point[], theme: Theme): void {
  const tip = way.at(-1) as Point;
  const far = way.filter(({ x, y }) => Math.hypot(x - tip.x, y - tip.y) > 5);
  const before = far.at(-1) ?? (way[0] as Point);
  const direction = Math.atan2(tip.y - before.y, tip.x - before.x);
  context.beginPath();
  for (const { x, y } of way) context.lineTo(x, y);
  context.strokeStyle = context.fillStyle = theme.ink;
  context.lineWidth = 2;
  context.stroke();
  context.beginPath();
  for (const [along, across] of [
    [3, 0],
    [-6, 4.5],
    [-6, -4.5],
  ] as const) {
    const [cos, sin] = [Math.cos(direction), Math.sin(direction)];
    context.lineTo(tip.x + along * cos - across * sin, tip.y + along * sin + across * cos);
  }
  context.closePath();
  context.fill();
}
