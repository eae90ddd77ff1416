import type { Box, Point } from "../shared/box.ts";
import { stroke, write } from "../shared/canvas.ts";
import { make, setHidden, setText } from "../shared/dom.ts";
import { toMetres } from "../shared/format.ts";
import {
  decodeRing,
  distanceOf,
  type Mount,
  type Poses,
  type Ring,
  type Sonar,
  type SonarAbout,
  toPlaced,
} from "../shared/frames/ring.ts";
import { NOTHING_IN_RANGE, READING } from "../shared/frames/scan.ts";
import { onChange } from "../shared/model.ts";
import { toPixel } from "../shared/projection.ts";
import { type Theme, textFont } from "../shared/theme.ts";
import type { SampleTraits } from "../shared/traits.ts";
import { Companion } from "./companion.ts";
import { type Depth, type Host, isFree, type Layer, type Painter, type Stage } from "./layer.ts";

const DASHES = [3, 3];
/** Radians of an arc between two of its points. */
const STEP = Math.PI / 60;
/** Pixels of words. */
const LINE = 14;

/** The traits of a sonar widget that the layer reads. */
interface RingTraits extends SampleTraits {
  poses: Poses;
  field_of_view: number;
}

/** A sensor on the robot, in metres and radians of the scanner's frame. */
export interface Beam {
  name: string;
  x: number;
  y: number;
  yaw: number;
  /** Radians of its opening. */
  view: number;
  /** Metres up to which its outline goes. */
  reach: number;
  isReading: boolean;
  /** True if something is nearer than the sensor can measure. */
  isTooClose: boolean;
}

/** The beams of a ring that stand in the picture: only sensors with a measurement and a known pose. */
export function toBeams(ring: Ring, about: SonarAbout, poses: Poses, usual: number, scanner: Place): Beam[] {
  return toPlaced(ring, about, poses, usual).flatMap(({ name, mount, sonar, view }) => {
    if (!mount.isKnown || !isThere(sonar)) return [];
    const isReading = sonar.kind === READING;
    const isTooClose = isClose(sonar);
    const reach = isReading ? sonar.range : isTooClose ? sonar.minRange : sonar.maxRange;
    return [{ name, ...asSeen(scanner, mount), view, reach, isReading, isTooClose }];
  });
}

/** Metres and radians of the scanner on the robot. */
type Place = [x: number, y: number, yaw: number];

/** Returns true if a sensor has a recent measurement. */
function isThere(sonar: Sonar): boolean {
  const { kind, behind, silentAfter } = sonar;
  return behind <= silentAfter && (kind === READING || kind === NOTHING_IN_RANGE || isClose(sonar));
}

function isClose(sonar: Sonar): boolean {
  return sonar.kind !== READING && distanceOf(sonar) === 0;
}

/** A place on the robot in the frame of the scanner. */
function asSeen([sx, sy, turn]: Place, { x, y, yaw }: Mount): { x: number; y: number; yaw: number } {
  const [dx, dy, cos, sin] = [x - sx, y - sy, Math.cos(turn), Math.sin(turn)];
  return { x: cos * dx + sin * dy, y: cos * dy - sin * dx, yaw: yaw - turn };
}

/** The cones of a ring of sonars on the picture of a laser. */
export class SonarLayer implements Layer {
  readonly traits = ["_sonar_of", "_robot"] as const;
  readonly #host: Host;
  readonly #sonar: Companion<Ring, RingTraits>;
  readonly #words = make("span", "");
  #beams: Beam[] = [];

  constructor(host: Host) {
    const { model, card, signal } = host;
    this.#host = host;
    this.#sonar = new Companion(model, decodeRing, card.redraw, signal);
    card.footer.append(this.#words);
    const follow = () => this.#sonar.follow(model.get("_sonar_of") ?? "");
    onChange(model, ["_sonar_of"], follow, signal);
    follow();
  }

  painters(): Partial<Record<Depth, Painter>> {
    const { shown, model } = this.#sonar;
    this.#beams = [];
    if (!shown || !model) return {};
    const { scanner = [0, 0, 0] } = this.#host.model.get("_robot");
    const { about } = this.#sonar;
    this.#beams = toBeams(shown, about, model.get("poses"), model.get("field_of_view"), scanner);
    return {
      edges: (context, stage, theme) => {
        for (const beam of this.#beams) drawBeam(context, stage, beam, theme);
      },
      words: (context, stage, theme) => {
        for (const beam of this.#beams) drawWords(context, stage, beam, theme);
      },
    };
  }

  place(): void {
    const { shown, title } = this.#sonar;
    const [count, drawn] = [shown?.sonars.length ?? 0, this.#beams.length];
    const rest = drawn < count ? `, ${count - drawn} of ${count} without a reading or a place` : "";
    setText(this.#words, count ? `cones: ${title || "sonars"}${rest}` : "");
    // Empty, it would take a place in the footer.
    setHidden(this.#words, !count);
  }
}

/** A point so far from a sensor, at an angle from its axis. */
function pointOf({ projection }: Stage, { x, y, yaw }: Beam, distance: number, angle: number): Point {
  const [ahead, aside] = [x + distance * Math.cos(yaw + angle), y + distance * Math.sin(yaw + angle)];
  return toPixel(projection, Math.hypot(ahead, aside), Math.atan2(aside, ahead));
}

/** The points of the arc at the end of a beam that lie within the picture. */
function arcOf(stage: Stage, beam: Beam): Point[] {
  const reach = Math.min(beam.reach, 3 * stage.projection.viewRange);
  const count = Math.max(2, Math.ceil(beam.view / STEP));
  return Array.from({ length: count + 1 }, (_, i) => pointOf(stage, beam, reach, (i / count - 0.5) * beam.view));
}

function drawBeam(context: CanvasRenderingContext2D, stage: Stage, beam: Beam, theme: Theme): void {
  const { centerX, centerY, radius } = stage.projection;
  context.save();
  context.beginPath();
  context.arc(centerX, centerY, radius, 0, 2 * Math.PI);
  context.clip();
  const arc = arcOf(stage, beam);
  context.beginPath();
  for (const { x, y } of [pointOf(stage, beam, 0, 0), ...arc]) context.lineTo(x, y);
  context.closePath();
  context.setLineDash(beam.isReading ? [] : DASHES);
  stroke(context, theme.guide, 1.25);
  context.setLineDash([]);
  if (beam.isReading || beam.isTooClose) {
    context.beginPath();
    for (const { x, y } of arc) context.lineTo(x, y);
    stroke(context, theme.reading, 2.5);
  }
  context.restore();
}

/** Writes the name inside of a cone, and its distance outside, if the place is free. */
function drawWords(context: CanvasRenderingContext2D, stage: Stage, beam: Beam, theme: Theme): void {
  const { viewRange, radius } = stage.projection;
  const reach = Math.min(beam.reach, viewRange);
  const gap = (LINE * viewRange) / radius;
  const isMet = beam.isReading || beam.isTooClose;
  const distance = beam.isReading ? toMetres(beam.reach, viewRange) : isMet ? "too close" : "nothing";
  writeWhereFree(context, stage, pointOf(stage, beam, reach + (isMet ? gap : -gap), 0), distance, theme.ink, theme);
  writeWhereFree(context, stage, pointOf(stage, beam, 0.6 * reach, 0), beam.name, theme.muted, theme);
}

function writeWhereFree(
  context: CanvasRenderingContext2D,
  stage: Stage,
  { x, y }: Point,
  text: string,
  color: string,
  theme: Theme,
): void {
  const font = textFont(theme);
  context.font = font;
  const width = context.measureText(text).width + 4;
  const box: Box = { x: x - width / 2, y: y - LINE / 2, width, height: LINE };
  if (!isFree(stage, box)) return;
  stage.labels.push(box);
  write(context, text, x, y, color, font, "center", theme.area);
}
