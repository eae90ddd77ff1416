import type { Box } from "../shared/box.ts";
import { boxWithin, make, makeButton, makeIcon, RESET, set, setHidden, setText } from "../shared/dom.ts";
import type { Speeds } from "../shared/frames/speeds.ts";
import { LaidOut } from "../shared/laid_out.ts";
import { type Model, onChange, setTraits } from "../shared/model.ts";
import { setHeld } from "../shared/room.ts";
import { SampleCard } from "../shared/sample_card.ts";
import type { Stream } from "../shared/stream.ts";
import { TimeLinesView } from "../shared/time_lines_view.ts";
import { groupsOf, type Layout, layoutOf } from "./axes.ts";
import type { Column } from "./column.ts";
import { type AxisFacts, type Fastest, type GroupFacts, hasPeaks, toFacts, toFastest } from "./facts.ts";
import { watchGestures } from "./gestures.ts";
import { GroupView } from "./group.ts";
import { Legend } from "./legend.ts";
import { Popup } from "./popup.ts";
import { toClearance } from "./scale.ts";
import { describeAxis, summarize, toSentence } from "./text.ts";
import { toTimeLines } from "./time_lines.ts";
import type { SpeedTraits } from "./traits.ts";

const SETTINGS = [
  "linear_limits",
  "angular_limits",
  "limits",
  "planar",
  "hold_peaks",
  "_resets",
  "command_title",
  "bars",
  "over_time",
] as const;
const NOTHING: Fastest = { linear: 0, angular: 0, steering: 0 };
/** Seconds that the button sets. */
const USUAL_SECONDS = 10;

const LINE = "M1 1h1.4v8.6H11V11H1z M3.4 7.2l2.2-3 2 1.8L10 2.4l.9.8-3.1 4.6-2-1.8-1.4 2z";

/** One view of a speed widget: it wires the card, the groups of bars, the legend, the pop-up and the gestures. */
export class SpeedView {
  readonly #model: Model<SpeedTraits>;
  readonly #stream: Stream<Speeds>;
  readonly #card: SampleCard;
  readonly #board = make("div", "rw-board");
  readonly #empty = make("div", "rw-empty");
  readonly #planar: HTMLButtonElement;
  readonly #reset: HTMLButtonElement;
  readonly #overTime: HTMLButtonElement;
  readonly #lines: TimeLinesView;
  readonly #legend: Legend;
  readonly #popup: Popup;
  /** All tracks are as high as the first. */
  readonly #track: LaidOut;
  #groups: GroupView[] = [];
  #boxes = new Map<Column, Box>();
  #boxKey = "";
  #isPlanar: boolean | null = null;
  #layout: Layout = "velocity";
  #hovered: number | null = null;
  #picked: number | null = null;
  /** Kept, so that the scale of axes without limits grows and never jumps back; a reset of the peaks resets it. */
  #fastest: Fastest = { ...NOTHING };
  #resets: number | null = null;
  /** True after keys have moved to an axis that was not announced to a screen reader. */
  #walked = false;

  constructor(model: Model<SpeedTraits>, element: HTMLElement, stream: Stream<Speeds>, signal: AbortSignal) {
    this.#model = model;
    this.#stream = stream;
    this.#card = new SampleCard(element, "speed", model, stream, () => this.#draw(), signal);
    const { picture, footer } = this.#card;
    // Screen readers leave the arrow keys to it.
    picture.role = "application";
    picture.append(this.#board, this.#empty);
    this.#popup = new Popup(picture, signal);
    this.#track = new LaidOut(this.#card.redraw, signal);
    this.#lines = new TimeLinesView(picture, this.#card.redraw, signal);
    this.#legend = new Legend(footer);
    this.#planar = makeButton(
      "",
      "Planar: show linear x, linear y and yaw only",
      () => this.#onPlanar(),
      signal,
      "Planar",
    );
    this.#reset = makeButton("rw-reset", "Reset the peaks", () => this.#onReset(), signal);
    this.#reset.append(makeIcon(RESET), make("span", "rw-word", "Peaks"));
    const onOverTime = () => setTraits(model, { over_time: model.get("over_time") ? 0 : USUAL_SECONDS });
    this.#overTime = makeButton("rw-speed-lines", "Over time: the last seconds of each axis", onOverTime, signal);
    this.#overTime.append(makeIcon(LINE));
    this.#card.addControls(this.#reset, this.#overTime, this.#planar);
    onChange(model, SETTINGS, this.#card.redraw, signal);
    watchGestures(picture, this, signal);
  }

  onHover(axis: number | null): void {
    if (this.#hovered === axis) return;
    this.#hovered = axis;
    this.#card.redraw();
  }

  onPick(axis: number | null): void {
    this.#picked = this.#picked === axis ? null : axis;
    this.#card.redraw();
  }

  onWalk(to: string): void {
    const axes = this.#columns.map(({ axis }) => axis.index);
    const last = axes.length - 1;
    const at = axes.indexOf(this.#picked ?? -1);
    const places: Record<string, number> = {
      first: 0,
      last,
      next: Math.min(last, at + 1),
      previous: Math.max(0, at - 1),
    };
    this.#picked = axes[places[to] ?? -1] ?? null;
    this.#walked = true;
    this.#card.redraw();
  }

  get #columns(): Column[] {
    return this.#groups.flatMap(({ columns }) => columns);
  }

  #onPlanar(): void {
    setTraits(this.#model, { planar: !this.#model.get("planar") });
  }

  #onReset(): void {
    setTraits(this.#model, { _resets: this.#model.get("_resets") + 1 });
  }

  #draw(): void {
    const [model, speeds] = [this.#model, this.#stream.shown];
    const planar = model.get("planar");
    const marksPeaks = model.get("hold_peaks") && hasPeaks(speeds);
    // Hide the old peaks at once; Python sends new ones when it has handled the reset.
    const isReset = !this.#stream.paused && speeds?.resets !== model.get("_resets");
    if (!isReset && speeds && this.#resets !== speeds.resets) {
      this.#resets = speeds.resets;
      this.#fastest = { ...NOTHING };
    }
    this.#fastest = toFastest(speeds, planar, this.#fastest);
    const groups = toFacts(speeds, {
      limits: {
        linear: model.get("linear_limits"),
        angular: model.get("angular_limits"),
        axes: model.get("limits"),
      },
      planar,
      marksPeaks: marksPeaks && !isReset,
      fastest: this.#fastest,
    });
    const shown = groups.flatMap(({ axes }) => axes);
    const hidden = groups.flatMap((group) => group.hidden);
    this.#layOut(planar, layoutOf(speeds));
    const hasLimits = shown.some(({ limits }) => limits);
    this.#drawCard(speeds, hasLimits, marksPeaks, summarize(shown, hidden));
    const clearance = toClearance(this.#track.height);
    for (const [g, view] of this.#groups.entries()) {
      const facts = groups[g];
      if (facts) view.update(facts, clearance);
    }
    this.#drawOverTime(groups);
    this.#drawPopup(shown);
  }

  #drawOverTime(groups: GroupFacts[]): void {
    const seconds = this.#model.get("over_time");
    set(this.#overTime, "ariaPressed", String(seconds > 0));
    const { paused, rate } = this.#stream;
    // Samples that are picked from a recording have no time of arrival.
    const isLive = !Number.isNaN(rate);
    const moments = seconds && isLive ? this.#stream.last(Infinity) : [];
    const samples = moments.map((moment) => ({ at: moment.at, frame: this.#stream.frameOf(moment) }));
    const end = paused ? "frozen" : isLive ? "now" : "no live speeds";
    const { theme, size } = this.#card;
    this.#lines.draw(seconds ? toTimeLines(samples, groups, seconds) : null, seconds, end, theme, size.ratio);
  }

  #layOut(planar: boolean, layout: Layout): void {
    if (planar === this.#isPlanar && layout === this.#layout) return;
    this.#isPlanar = planar;
    this.#layout = layout;
    this.#groups = groupsOf(layout).map((group) => new GroupView(group, planar));
    const isFew = planar || layout === "car";
    this.#board.classList.toggle("rw-planar", isFew);
    setHeld(this.#card.root, "planar", isFew);
    this.#card.root.classList.toggle("rw-both", layout === "both");
    this.#board.replaceChildren(...this.#groups.map(({ root }) => root));
    const [first] = this.#columns;
    if (first) this.#track.of(first.track);
  }

  #drawCard(speeds: Speeds | null, hasLimits: boolean, marksPeaks: boolean, summary: string): void {
    const model = this.#model;
    const bars = model.get("bars");
    const isCommanded = bars === "commanded";
    const command = speeds?.commanded ? `with ${model.get("command_title") || "commands"}` : "";
    this.#card.update([this.#stream.about.frame_id ?? "", isCommanded ? bars : "", command], "speed");
    this.#card.root.classList.toggle("rw-bars-commanded", isCommanded);
    this.#board.style.paddingTop = `${this.#card.noticeHeight}px`;
    set(this.#planar, "ariaPressed", String(model.get("planar")));
    setHidden(this.#planar, this.#layout === "car");
    setHidden(this.#reset, !marksPeaks);
    setHidden(this.#empty, speeds !== null);
    setText(this.#empty, this.#card.waiting("speed"));
    this.#board.classList.toggle("rw-commanded", Boolean(speeds?.commanded));
    this.#legend.update(bars, Boolean(speeds?.commanded), hasLimits, marksPeaks, summary);
  }

  #drawPopup(shown: AxisFacts[]): void {
    const index = this.#hovered ?? this.#picked;
    const facts = shown.find(({ axis }) => axis.index === index);
    const column = this.#columns.find(({ axis }) => axis.index === index);
    const picked = shown.find(({ axis }) => axis.index === this.#picked);
    if (this.#walked) this.#card.say(picked ? toSentence(describeAxis(picked)) : []);
    this.#walked = false;
    for (const { root, axis } of this.#columns) root.classList.toggle("rw-pointed", axis.index === index);
    if (facts && column) this.#popup.show(describeAxis(facts), this.#boxOf(column), this.#card.size);
    else this.#popup.hide();
  }

  /** The place of a column's track in the picture: measured once for each size of the picture. */
  #boxOf(column: Column): Box {
    const { width, height } = this.#card.size;
    const key = [width, height, this.#card.noticeHeight, this.#isPlanar, this.#layout, this.#track.height].join();
    if (key !== this.#boxKey) this.#boxes.clear();
    this.#boxKey = key;
    const box = this.#boxes.get(column) ?? boxWithin(this.#card.picture, column.track);
    this.#boxes.set(column, box);
    return box;
  }
}
