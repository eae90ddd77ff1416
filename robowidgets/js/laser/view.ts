import { type Surface, watchSize } from "../shared/canvas.ts";
import { boxWithin, make, makeButton, setText } from "../shared/dom.ts";
import { toMany, toShortMetres } from "../shared/format.ts";
import { type Model, onChange, setTraits } from "../shared/model.ts";
import { offerPng } from "../shared/png.ts";
import { SampleCard } from "../shared/sample_card.ts";
import { perAnimationFrame, READING_MS, throttle } from "../shared/schedule.ts";
import type { Stream } from "../shared/stream.ts";
import { watchGestures } from "./gestures.ts";
import { Legend } from "./legend.ts";
import { pick } from "./pick.ts";
import { Popup } from "./popup.ts";
import { placePopup } from "./popup_place.ts";
import type { Box, Point } from "./projection.ts";
import type { Scan } from "./scan.ts";
import { Scene, SETTINGS } from "./scene.ts";
import { describeRay, toSentence, whyEmpty } from "./text.ts";
import type { LaserTraits } from "./traits.ts";
import { stepRange } from "./zoom.ts";

const TRAITS = [...SETTINGS, "marks", "color_by_intensity", "hovered", "pinned"] as const;

/** Rays that the keys for a page walk. */
const FAR = 10;

/** One view of a laser widget: it wires the card, the scene, the legend, the pop-ups and the gestures together. */
export class LaserView {
  readonly #model: Model<LaserTraits>;
  readonly #stream: Stream<Scan>;
  readonly #card: SampleCard;
  readonly #scene: Scene;
  readonly #legend: Legend;
  readonly #pinned: Popup;
  readonly #hovered: Popup;
  readonly #empty = make("div", "rw-empty");
  readonly #range = make("span", "rw-range");
  readonly #fit: HTMLButtonElement;
  readonly #redraw: () => void;
  readonly #tell: () => void;
  #size: Surface = { width: 0, height: 0, ratio: 1 };

  constructor(model: Model<LaserTraits>, element: HTMLElement, stream: Stream<Scan>, signal: AbortSignal) {
    this.#model = model;
    this.#stream = stream;
    this.#redraw = perAnimationFrame(() => this.#draw(), signal);
    const tell = () => this.#legend.update(stream.shown, model.get("marks"), this.#scene.viewRange);
    this.#tell = throttle(tell, READING_MS, signal);
    this.#card = new SampleCard(element, "laser", model, stream, this.#redraw, signal);
    const { picture, footer } = this.#card;
    // Screen readers leave the arrow keys to it.
    picture.role = "application";
    this.#scene = new Scene(model, picture);
    this.#legend = new Legend(footer, model, signal);
    this.#pinned = new Popup(picture);
    this.#hovered = new Popup(picture);
    picture.append(this.#empty);

    const closer = makeButton("rw-zoom", "Zoom in (+)", () => this.onZoom(-1), signal, "+");
    const farther = makeButton("rw-zoom", "Zoom out (\u2212)", () => this.onZoom(1), signal, "\u2212");
    this.#fit = makeButton("rw-fit", "Fit the view to readings", () => this.#onFit(), signal, "Fit");
    this.#card.addControls(farther, this.#range, closer, this.#fit);

    stream.listen(this.#redraw, signal);
    onChange(model, TRAITS, this.#redraw, signal);
    watchGestures(picture, this, signal);
    const onSize = (size: Surface) => {
      this.#size = size;
      this.#draw();
    };
    const resize = watchSize(picture, onSize, signal);
    const draw = (ratio?: number) => {
      tell();
      resize(ratio);
    };
    offerPng(this.#card, model, draw, signal);
  }

  onHover(point: Point | null): void {
    this.#setIndex("hovered", point ? this.#indexAt(point) : -1);
  }

  onPick(point: Point): void {
    const index = this.#indexAt(point);
    this.#setIndex("pinned", index === this.#model.get("pinned") ? -1 : index);
  }

  onWalk(to: string): void {
    const scan = this.#stream.shown;
    if (!scan?.count) return;
    const last = scan.count - 1;
    const from = this.#model.get("pinned") ?? this.#model.get("hovered");
    const middle = Math.floor(last / 2);
    const next = {
      next: from === null ? middle : from + 1,
      previous: from === null ? middle : from - 1,
      forth: from === null ? middle : from + FAR,
      back: from === null ? middle : from - FAR,
      first: 0,
      last,
      nearest: scan.nearest,
    };
    const index = next[to as keyof typeof next] ?? -1;
    if (to === "nearest" && index < 0) {
      this.#card.say(["no reading"]);
      return;
    }
    const walked = to === "none" ? -1 : Math.min(last, Math.max(0, index));
    this.#setIndex("pinned", walked);
    this.#card.say(walked < 0 ? [] : toSentence(describeRay(scan, walked)));
  }

  onZoom(direction: -1 | 1): void {
    const range = this.#zoomed(direction);
    setTraits(this.#model, { view_range: range === this.#maxRange ? "sensor" : range });
  }

  canZoom(direction: -1 | 1): boolean {
    return this.#zoomed(direction) !== this.#scene.viewRange;
  }

  get #maxRange(): number {
    return this.#stream.shown?.maxRange ?? this.#scene.viewRange;
  }

  #zoomed(direction: -1 | 1): number {
    return stepRange(this.#scene.viewRange, direction, this.#maxRange);
  }

  #onFit(): void {
    setTraits(this.#model, { view_range: this.#model.get("view_range") === "data" ? "sensor" : "data" });
  }

  #indexAt(point: Point): number {
    const scan = this.#stream.shown;
    return scan ? pick(this.#scene.projection, scan, point) : -1;
  }

  #setIndex(name: "hovered" | "pinned", index: number): void {
    const value = index < 0 ? null : index;
    if (this.#model.get(name) !== value) setTraits(this.#model, { [name]: value });
  }

  #draw(): void {
    if (this.#size.width === 0) return;
    const scan = this.#stream.shown;
    const { theme } = this.#card;
    this.#card.update([this.#stream.about.frame_id ?? "", scan ? toMany(scan.count, "ray") : ""], "scan");
    setText(this.#empty, scan ? whyEmpty(scan, this.#stream.about.notes) : this.#card.waiting("scan"));
    this.#empty.hidden = !this.#empty.textContent;
    const covered = this.#empty.hidden ? [] : [boxWithin(this.#card.picture, this.#empty)];
    this.#scene.draw(scan, this.#size, this.#card.noticeHeight, covered, theme);
    this.#tell();
    setText(this.#range, toShortMetres(this.#scene.viewRange));
    this.#fit.ariaPressed = String(this.#model.get("view_range") === "data");
    this.#drawPopups(scan);
  }

  #drawPopups(scan: Scan | null): void {
    const [pinned, hovered] = [this.#model.get("pinned"), this.#model.get("hovered")];
    const others: Box[] = [];
    const show = (popup: Popup, index: number | null) => {
      if (!scan || index === null) return popup.hide();
      const { box, projection, occupied, labelBoxes } = this.#scene;
      const center = { x: projection.centerX, y: projection.centerY };
      const end = index < scan.count ? this.#scene.drawPointer(scan, index, this.#card.theme) : center;
      others.push(
        popup.show(describeRay(scan, index, projection.viewRange), (size) =>
          placePopup(size, box, center, end, occupied, others, labelBoxes),
        ),
      );
    };
    show(this.#pinned, pinned);
    show(this.#hovered, hovered === pinned ? null : hovered);
  }
}
