import type { Box } from "../shared/box.ts";
import { make, makeButton, makeIcon, set, setHidden, setLabel, setText } from "../shared/dom.ts";
import { onAbort } from "../shared/events.ts";
import { toMany, toShortMetres } from "../shared/format.ts";
import type { Scan } from "../shared/frames/scan.ts";
import { LaidOut } from "../shared/laid_out.ts";
import { type Model, onChange, setTraits } from "../shared/model.ts";
import { FORWARD } from "../shared/projection.ts";
import { SampleCard } from "../shared/sample_card.ts";
import type { Stream } from "../shared/stream.ts";
import { stepRange } from "../shared/zoom.ts";
import { ConditionLayer } from "./condition_layer.ts";
import { FreeLayer } from "./free_layer.ts";
import { watchGestures } from "./gestures.ts";
import { Ghost } from "./ghost.ts";
import { GhostLayer } from "./ghost_layer.ts";
import { GuideLayer } from "./guide_layer.ts";
import { sweepHeight } from "./guides.ts";
import { HelpLayer } from "./help_layer.ts";
import { HighlightLayer } from "./highlight_layer.ts";
import type { Host, Layer, Stage } from "./layer.ts";
import { Legend } from "./legend.ts";
import { LitLayer } from "./lit_layer.ts";
import { MountButton, shownBy } from "./mount.ts";
import { PinLayer } from "./pin_layer.ts";
import { PointerLayer } from "./pointer.ts";
import { ReadingLayer } from "./reading_layer.ts";
import { RobotLayer } from "./robot_layer.ts";
import { Scene, SETTINGS } from "./scene.ts";
import { SectorLayer } from "./sector_layer.ts";
import { ShapeLayer } from "./shape_layer.ts";
import { SonarLayer } from "./sonar_layer.ts";
import { SpreadLayer } from "./spread_layer.ts";
import { Strip } from "./strip.ts";
import { TrailLayer } from "./trail_layer.ts";
import type { LaserTraits } from "./traits.ts";
import { decideRange } from "./zoom.ts";

const GHOST =
  "M6 .5a4.3 4.3 0 0 0-4.3 4.3v6.7l1.5-1.2 1.4 1.2 1.4-1.2 1.4 1.2 1.4-1.2 1.5 1.2V4.800A4.300 4.300 0 0 0 6 .5z";

/** One view of a laser widget: it wires the card, the layers, the legend and the gestures together. */
export class LaserView implements Host {
  readonly model: Model<LaserTraits>;
  readonly stream: Stream<Scan>;
  readonly card: SampleCard;
  readonly signal: AbortSignal;
  readonly #scene: Scene;
  /** From the ground up. */
  readonly #layers: Layer[];
  readonly #legend: Legend;
  readonly #empty = make("div", "rw-empty");
  readonly #emptySize: LaidOut;
  readonly #range = make("span", "rw-range");
  readonly #fit: HTMLButtonElement;
  readonly #pin: HTMLButtonElement;
  readonly #type: HTMLButtonElement;
  readonly #ghost: Ghost;
  readonly #mount: MountButton;
  readonly #tell = () => this.#drawLegend();
  #strip: { view: Strip; end: AbortController } | null = null;

  constructor(model: Model<LaserTraits>, element: HTMLElement, stream: Stream<Scan>, signal: AbortSignal) {
    this.model = model;
    this.stream = stream;
    this.signal = signal;
    this.card = new SampleCard(element, "laser", model, stream, () => this.#draw(), signal);
    const { picture, footer } = this.card;
    // Screen readers leave the arrow keys to it.
    picture.role = "application";
    picture.setAttribute("aria-description", "Drag along an arc to select rays, or type them (t). All keys: ?");
    this.#scene = new Scene(model, picture);
    this.#legend = new Legend(footer, model, signal);
    this.#ghost = new Ghost(model, stream, this.card.redraw, signal);
    const spread = new SpreadLayer(model, stream);
    const sectors = new SectorLayer(this);
    footer.insertBefore(sectors.hint, footer.lastChild);
    const help = new HelpLayer(this);
    this.#layers = [
      new FreeLayer(model, stream),
      new GuideLayer(model, stream, this.#scene.measure),
      new TrailLayer(this),
      new GhostLayer(this.#ghost),
      spread,
      new RobotLayer(this),
      new ConditionLayer(this.card.lamps),
      new LitLayer(this),
      new SonarLayer(this),
      new ReadingLayer(model),
      new ShapeLayer(this),
      new PointerLayer(this, spread.wordsOf),
      new HighlightLayer(model),
      new PinLayer(this),
      sectors,
      help,
    ];
    picture.append(this.#empty);
    this.#emptySize = new LaidOut(this.card.redraw, signal).of(this.#empty);

    const closer = makeButton("rw-zoom", "Zoom in (+)", () => this.onZoom(-1), signal, "+");
    const farther = makeButton("rw-zoom", "Zoom out (\u2212)", () => this.onZoom(1), signal, "\u2212");
    this.#fit = makeButton("rw-fit", "Fit the view to readings", () => this.#onFit(), signal, "Fit");
    this.#pin = makeButton("rw-pin", "", () => this.#ghost.toggle(), signal);
    this.#pin.append(makeIcon(GHOST));
    this.#type = makeButton("rw-type", "Type rays to see them (t)", () => sectors.askRays(), signal, "[:]");
    this.#type.append(make("span", "rw-word", "Rays"));
    this.#mount = new MountButton(model, this.card.redraw, signal);
    picture.append(this.#mount.element);
    this.card.addControls(farther, this.#range, closer, this.#fit, this.#pin, this.#type, help.button);

    const traits = [...SETTINGS, "index_view", ...this.#layers.flatMap((layer) => layer.traits)] as const;
    onChange(model, traits, this.card.redraw, signal);
    watchGestures(picture, this.#layers, this, signal);
    onChange(model, ["forward"], () => this.#shape(), signal);
    this.#shape();
  }

  get stage(): Stage {
    return this.#scene.stage;
  }

  onZoom(direction: -1 | 1): void {
    const range = this.#zoomed(direction);
    setTraits(this.model, { view_range: range === this.#maxRange ? "sensor" : range });
  }

  canZoom(direction: -1 | 1): boolean {
    return this.#zoomed(direction) !== this.#viewRange;
  }

  /** The metres the view reaches now. */
  get #viewRange(): number {
    return this.stage.projection.viewRange;
  }

  get #maxRange(): number {
    return this.stream.shown?.maxRange ?? this.#viewRange;
  }

  #zoomed(direction: -1 | 1): number {
    return stepRange(this.#viewRange, direction, this.#maxRange);
  }

  #onFit(): void {
    setTraits(this.model, { view_range: this.model.get("view_range") === "data" ? "sensor" : "data" });
  }

  /**
   * Makes the picture no higher than the sweep of the scan that is on show when the view is made. An empty picture
   * keeps its height, so that the first scan moves nothing on the page.
   */
  #shape(): void {
    const { model, stream, card } = this;
    const scan = stream.shown;
    if (!scan?.count) return;
    const forward = FORWARD[model.get("forward")] ?? 0;
    const { part, pixels } = sweepHeight(scan, model.get("ray_angles"), model.get("ray_count"), forward);
    const below = this.#layers.reduce((sum, layer) => sum + (layer.roomBelow?.(scan) ?? 0), 0);
    // Whole pixels, so that a saved picture has the size of the one on the screen.
    const height = `round(up, ${(100 * part).toFixed(1)}cqw + ${Math.ceil(pixels + below)}px, 1px)`;
    card.picture.style.setProperty("--rw-sweep-height", height);
  }

  #draw(): void {
    const scan = this.stream.shown;
    const decided = scan && this.model.get("view_range") === "auto" ? decideRange(scan) : null;
    if (decided) setTraits(this.model, { view_range: decided });
    const { empty = [], frame_id = "", made_of: [madeOf = ""] = [] } = this.stream.about;
    const words = scan ? empty.filter(Boolean).join("\n") : this.card.waiting("scan");
    const { noticeHeight } = this.card;
    const covered = [...(words ? [this.#emptyBox] : []), ...this.#mount.place(this.stream.about, noticeHeight)];
    this.#scene.draw(this.#layers, scan, this.card.size, noticeHeight, covered, this.card.theme);
    this.card.update([frame_id, scan ? toMany(scan.count, "ray") : "", madeOf], "scan");
    setText(this.#empty, words);
    setHidden(this.#empty, !words);
    this.card.texts.ask(this.#tell);
    this.#mount.update(this.stream.about);
    setText(this.#range, scan ? toShortMetres(this.#viewRange) : "");
    set(this.#type, "disabled", !scan);
    set(this.#fit, "ariaPressed", String(this.model.get("view_range") === "data"));
    for (const layer of [...this.#layers].reverse()) layer.place?.(this.stage);
    const hasGhost = this.#ghost.isSet;
    setHidden(this.#pin, !hasGhost && !this.model.get("index_view"));
    set(this.#pin, "ariaPressed", String(hasGhost));
    setLabel(this.#pin, hasGhost ? "Remove the ghost (g)" : "Keep this scan as a ghost to compare with (g)");
    this.#drawStrip(hasGhost);
  }

  /** The box of an empty picture, in its middle. */
  get #emptyBox(): Box {
    const { width, height } = this.#emptySize;
    const { size } = this.card;
    return { x: (size.width - width) / 2, y: (size.height - height) / 2, width, height };
  }

  #drawLegend(): void {
    const { shown, about } = this.stream;
    const { model } = this;
    const toShown = shownBy(model, about);
    this.#legend.update(shown, model.get("marks"), this.#viewRange, model.get("angle_unit"), toShown);
  }

  /** Draws the index view: if the trait enables it, and below a ghost, whose difference it shows. */
  #drawStrip(hasGhost: boolean): void {
    if ((this.model.get("index_view") || hasGhost) === (this.#strip !== null)) {
      this.#strip?.view.draw();
    } else if (this.#strip) {
      this.#strip.end.abort();
      this.#strip.view.root.remove();
      this.#strip = null;
    } else {
      const end = new AbortController();
      onAbort(this.signal, () => end.abort());
      this.#strip = { view: new Strip(this, this.#layers, end.signal), end };
    }
  }
}
