import type { Point, Size } from "../shared/box.ts";
import { make, setHidden, setText } from "../shared/dom.ts";
import { angleOf, READING, type Scan } from "../shared/frames/scan.ts";
import { type Projection, toPixel } from "../shared/projection.ts";
import type { Theme } from "../shared/theme.ts";
import type { About } from "../shared/traits.ts";
import type { Depth, Host, Layer, Painter, Stage } from "./layer.ts";

/** Opacity of the oldest and of the newest. */
const FADED = [0.1, 0.5] as const;

/** The scans before the one on show, faded behind it: by odometry, or in the scanner's frame. */
export class TrailLayer implements Layer {
  readonly traits = ["trail"] as const;
  readonly #host: Host;
  readonly #words = make("span", "");
  #image: TrailImage | null = null;
  /** Empty unless a trail is enabled, and while the page has only the scan on show. */
  #placed: Placed[] = [];

  constructor(host: Host) {
    this.#host = host;
    host.card.footer.append(this.#words);
  }

  painters(): Partial<Record<Depth, Painter>> {
    const { model, stream } = this.#host;
    const trail = model.get("trail");
    const moments = trail ? stream.last(trail + 1) : [];
    this.#placed = placeScans(moments.map((moment) => ({ scan: stream.frameOf(moment), pose: moment.about.pose })));
    if (!this.#placed.length) return {};
    this.#image ??= new TrailImage();
    const image = this.#image;
    return { ghost: (context, stage, theme) => image.draw(context, stage, this.#placed, theme) };
  }

  place(): void {
    const count = this.#placed.length;
    const about = this.#host.stream.last(1)[0]?.about ?? {};
    setText(this.#words, count ? `trail of ${count}, ${placedWords(about)}` : "");
    // Empty, it would take a place in the footer.
    setHidden(this.#words, !count);
  }
}

/** The source of the poses of earlier scans, by the facts about the scan on show. */
export function placedWords({ pose, placed_by = "odometry" }: About): string {
  return pose ? `by ${placed_by}` : "scanner\u2019s frame";
}

/** A scan, and the pose of its scanner in the frame of odometry, if it is known. */
interface Past {
  scan: Scan;
  pose: About["pose"];
}

/** A scan, and the pose of its scanner in the frame of the scanner now: metres and radians. */
export interface Placed extends Point {
  scan: Scan;
  turn: number;
}

/**
 * The scans before the last one, oldest first. If the pose of the last is known, the others are placed by their poses,
 * and scans without a pose are left out; else all stand at the scanner.
 */
export function placeScans(scans: Past[]): Placed[] {
  const here = scans.at(-1)?.pose;
  if (!here) return scans.slice(0, -1).map(({ scan }) => ({ scan, x: 0, y: 0, turn: 0 }));
  const [cos, sin] = [Math.cos(here[2]), Math.sin(here[2])];
  return scans.slice(0, -1).flatMap(({ scan, pose }) => {
    if (!pose) return [];
    const [dx, dy] = [pose[0] - here[0], pose[1] - here[1]];
    return [{ scan, x: cos * dx + sin * dy, y: cos * dy - sin * dx, turn: pose[2] - here[2] }];
  });
}

/**
 * Draws scans as dots by writing pixels: rectangles would take five times as long as all the rest of the picture. The
 * newest of several dots at one place shows.
 */
class TrailImage {
  readonly #canvas = new OffscreenCanvas(1, 1);
  readonly #context = this.#canvas.getContext("2d") as OffscreenCanvasRenderingContext2D;
  #image = new ImageData(1, 1);

  draw(context: CanvasRenderingContext2D, { projection, box }: Stage, scans: Placed[], theme: Theme): void {
    const [width, height] = [Math.ceil(box.width), Math.ceil(box.y + box.height)];
    if (this.#image.width !== width || this.#image.height !== height) {
      [this.#canvas.width, this.#canvas.height] = [width, height];
      this.#image = new ImageData(width, height);
    }
    const pixels = new Uint32Array(this.#image.data.buffer).fill(0);
    for (const [i, placed] of [...scans.entries()].reverse()) {
      const share = scans.length > 1 ? i / (scans.length - 1) : 1;
      fillDots(pixels, { width, height }, projection, placed, FADED[0] + share * (FADED[1] - FADED[0]));
    }
    this.#context.putImageData(this.#image, 0, 0);
    this.#context.globalCompositeOperation = "source-in";
    this.#context.fillStyle = theme.reading;
    this.#context.fillRect(0, 0, width, height);
    context.imageSmoothingEnabled = false;
    context.drawImage(this.#canvas, 0, 0);
  }
}

/** Fills the pixels of a scan's readings in view that are still empty with black of some opacity. */
function fillDots(
  pixels: Uint32Array,
  { width, height }: Size,
  projection: Projection,
  { scan, x, y, turn }: Placed,
  opacity: number,
): void {
  const { centerX, centerY, radius, viewRange, forward } = projection;
  const shade = (Math.round(255 * opacity) << 24) >>> 0;
  const origin = toPixel(projection, Math.hypot(x, y), Math.atan2(y, x));
  for (let i = 0; i < scan.count; i++) {
    if (scan.kinds[i] !== READING) continue;
    const angle = angleOf(scan, i) + turn + forward;
    const length = ((scan.ranges[i] as number) / viewRange) * radius;
    const left = origin.x + length * Math.cos(angle);
    const top = origin.y - length * Math.sin(angle);
    if ((left - centerX) ** 2 + (top - centerY) ** 2 > radius ** 2) continue;
    const column = Math.round(left) - 1;
    const row = Math.round(top) - 1;
    if (column < 0 || row < 0 || column > width - 2 || row > height - 2) continue;
    const upper = row * width + column;
    const lower = upper + width;
    pixels[upper] ||= shade;
    pixels[upper + 1] ||= shade;
    pixels[lower] ||= shade;
    pixels[lower + 1] ||= shade;
  }
}
