import type { Point } from "../shared/box.ts";
import { write } from "../shared/canvas.ts";
import { angleOf, READING, type Scan } from "../shared/frames/scan.ts";
import { setTraits } from "../shared/model.ts";
import { toSentence } from "../shared/popup.ts";
import { toPixel } from "../shared/projection.ts";
import type { Theme } from "../shared/theme.ts";
import { type Depth, type Host, isFree, type Layer, type Painter, type Stage, type Stops } from "./layer.ts";
import { shownBy } from "./mount.ts";
import { describeRay } from "./text.ts";

const RING = 6;
const HEIGHT = 16;

/** Rays that a program has pinned under names: a ring at the reading, or at the rim without one. */
export class PinLayer implements Layer {
  readonly traits = ["_pins"] as const;
  readonly #host: Host;
  #picked = "";

  constructor(host: Host) {
    this.#host = host;
  }

  painters(): Partial<Record<Depth, Painter>> {
    const pins = this.#pins;
    if (!pins.length) return {};
    const draw = (paint: (pin: Pin, name: string) => void, { scan, projection }: Stage) => {
      for (const [name, index] of pins) if (scan && index < scan.count) paint(pinAt(scan, projection, index), name);
    };
    return {
      rings: (context, stage, theme) => draw((pin) => drawRing(context, pin, theme), stage),
      names: (context, stage, theme) => draw((pin, name) => drawName(context, stage, pin.at, name, theme), stage),
    };
  }

  /** A picked pin is the pinned ray: its pop-up shows. */
  get stops(): Stops {
    const { model, stream, card } = this.#host;
    const scan = stream.shown;
    const pins = new Map(this.#pins.filter(([, index]) => scan && index < scan.count));
    const pick = (name: string) => {
      this.#picked = name;
      const index = pins.get(name) ?? null;
      setTraits(model, { pinned: index });
      if (scan && index !== null)
        card.say([
          name,
          ...toSentence(describeRay(scan, index, 1, model.get("angle_unit"), "", shownBy(model, stream.about))),
        ]);
    };
    const isPicked = pins.get(this.#picked) === model.get("pinned");
    return { names: [...pins.keys()], picked: isPicked ? this.#picked : "", pick };
  }

  get #pins(): [string, number][] {
    return Object.entries(this.#host.model.get("_pins"));
  }
}

interface Pin {
  at: Point;
  isReading: boolean;
}

function pinAt(scan: Scan, projection: Stage["projection"], index: number): Pin {
  const range = scan.ranges[index] as number;
  const isReading = scan.kinds[index] === READING && range <= projection.viewRange;
  const far = isReading ? range : Math.min(scan.maxRange, projection.viewRange);
  return { at: toPixel(projection, far, angleOf(scan, index)), isReading };
}

function drawRing(context: CanvasRenderingContext2D, { at, isReading }: Pin, theme: Theme): void {
  context.beginPath();
  context.arc(at.x, at.y, RING, 0, 2 * Math.PI);
  context.setLineDash(isReading ? [] : [3, 3]);
  context.strokeStyle = theme.pointer;
  context.lineWidth = 2;
  context.stroke();
  context.setLineDash([]);
}

/** Writes a name next to its ring, if there is room. */
function drawName(context: CanvasRenderingContext2D, stage: Stage, { x, y }: Point, name: string, theme: Theme): void {
  const font = `650 12px ${theme.font}`;
  context.font = font;
  const [width, gap] = [context.measureText(name).width + 6, RING + 3];
  const places = [
    [gap, -HEIGHT / 2],
    [-gap - width, -HEIGHT / 2],
    [-width / 2, -gap - HEIGHT],
    [-width / 2, gap],
    [gap, -gap - HEIGHT],
    [gap, gap],
    [-gap - width, -gap - HEIGHT],
    [-gap - width, gap],
  ] as const;
  const boxes = places.map(([left, top]) => ({ x: x + left, y: y + top, width, height: HEIGHT }));
  const box = boxes.find((one) => isFree(stage, one));
  if (!box) return;
  stage.covered.push(box);
  write(context, name, box.x + width / 2, box.y + HEIGHT / 2, theme.pointer, font, "center", theme.area);
}
