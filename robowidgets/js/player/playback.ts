import { toBytes } from "../shared/bytes.ts";
import { onAbort } from "../shared/events.ts";
import { type Mark, markBeside } from "../shared/marks.ts";
import { lacksKernel, onChange, onMessage, setTraits } from "../shared/model.ts";
import { perAnimationFrame, throttle } from "../shared/schedule.ts";
import type { Span } from "../shared/time_axis.ts";
import type { Pointing } from "../shared/traits.ts";
import { followLeader, type PlayerModel } from "./leader.ts";
import { type Follower, give, type Host, type Moved, type Target } from "./moved.ts";
import { Prefetcher } from "./prefetch.ts";
import { decodeFrames, Segments, type Shown, type Track } from "./segments.ts";
import { Targets } from "./targets.ts";
import type { SegmentMessage } from "./traits.ts";

/** A time, and the direction of a step from there. */
type Step = [from: number, direction: -1 | 1];

/** A segment; or only a time that the program seeks, or to which a step leads. */
type Message = Partial<SegmentMessage> & { seek?: number; step?: Step };

const TELL_MS = 200;
/** Seconds of wall time; a smaller difference to another page's time is not a seek. */
const APART = 0.5;

/** Plays a recording in the page: one time for all widgets, from segments that Python prefetches. */
export class Playback {
  readonly #model: PlayerModel;
  readonly #segments: Segments;
  readonly #prefetcher: Prefetcher;
  readonly #listeners = new Set<() => void>();
  readonly #tell: () => void;
  readonly #nextFrame: () => void;
  #followers: Follower[] = [];
  /** True while widgets are set to the frames on show. */
  #isGiving = false;
  #targets = new Targets([]);
  #time: number;
  /** The thing under the pointer; all widgets show its moment until the pointer leaves. */
  #pointed: Pointing["_pointed"] = null;
  /** The moment at which the widgets are frozen; null while they are not. */
  #frozenAt: number | null = null;
  /** The newest step that the page could not take yet, because it lacks a segment; null without one. */
  #wished: Step | null = null;
  /** True if frozen widgets go to the time, too, once the page has its segment: a step led there. */
  #movesFrozen = false;
  /** Index of the ray that the laser shows because the user points at it on the scanogram. */
  #ray: number | null = null;
  /** True while the player that this one follows is outside of this recording. */
  #isLost = false;
  #joined: { of: Mark[][]; marks: Mark[] } = { of: [], marks: [] };
  #last = 0;
  /** True while the segment of the moment on show is missing. */
  #lacks = true;

  constructor(model: PlayerModel, find: () => Promise<Moved>, signal: AbortSignal) {
    this.#model = model;
    this.#time = model.get("time");
    this.#segments = new Segments(model.get("_segment"));
    this.#prefetcher = new Prefetcher(this.#segments, (time) => model.send({ pointed: time }), signal);
    this.#tell = throttle(() => setTraits(model, { time: this.#time }), TELL_MS, signal);
    // Before the cards, which show the time that it sets.
    this.#nextFrame = perAnimationFrame(() => this.#advance(), signal, true);
    onChange(model, ["time"], () => this.#onTime(), signal);
    onChange(model, ["playing"], () => this.#onPlaying(), signal);
    onChange(model, ["speed", "loop", "selection", "marks", "_status", "_leader"], () => this.#changed(), signal);
    onMessage(model, (message: Message, buffers) => this.#onMessage(message, buffers), signal);
    followLeader(model, (time, isSent) => this.#goToPlace(time, isSent), signal);
    let change = new AbortController();
    onAbort(signal, () => change.abort());
    const move = async () => {
      change.abort();
      change = new AbortController();
      const now = change.signal;
      // Frames and targets belong together.
      this.#targets = new Targets([]);
      this.#segments.clear();
      for (const first of model.get("_first")) this.#onMessage(first, first.tracks);
      const found = await find();
      if (!now.aborted && !signal.aborted) this.#move(found, now);
    };
    onChange(model, ["_targets"], move, signal);
    move().then(() => {
      // Another page may have segments; this one has none.
      model.send({ have: "nothing" });
      this.#onPlaying();
    });
  }

  /** Moves these models until others are to be moved. */
  #move(found: Moved, signal: AbortSignal): void {
    this.#followers = found.followers;
    this.#targets = new Targets(found.targets);
    for (const follower of found.followers) this.#follow(follower, signal);
    for (const target of found.targets) {
      this.#watchFreezing(target, signal);
      this.#watchPicking(target, signal);
      onChange(target, ["trail", "spread"], () => this.#show(), signal);
      // After all traits from the kernel are set.
      const onGiven = () => this.#isGiving || queueMicrotask(() => signal.aborted || this.#show());
      onChange(target, ["_frame", "_about"], onGiven, signal);
    }
    this.#show();
  }

  get time(): number {
    return this.#time;
  }

  /** The moment on show: the one under the pointer, else the time. Widgets that lack it are pale. */
  get shown(): number {
    return this.#pointed?.time ?? this.#time;
  }

  /** The thing under the pointer, if the page has its moment. */
  get #previewed(): Pointing["_pointed"] {
    return this.#pointed && this.#segments.has(this.#pointed.time) ? this.#pointed : null;
  }

  /** True while a segment is missing: for the moment on show, or for a step. */
  get waits(): boolean {
    return this.#lacks || this.#wished !== null;
  }

  /** The text while the player that this one follows is outside of this recording; else "". */
  get lost(): string {
    return (this.#isLost && this.#model.get("_leader").lost) || "";
  }

  get begin(): number {
    return this.#model.get("_begin");
  }

  get duration(): number {
    return this.#model.get("duration");
  }

  get playing(): boolean {
    return this.#model.get("playing");
  }

  /**
   * The span that is played: the selection while it is looped, else all; without a kernel, the part that the page has.
   */
  get span(): [number, number] {
    const chosen = this.#model.get("selection");
    const [start, end] = (chosen && this.#model.get("loop") ? chosen : [this.begin, this.duration]).map((time) =>
      this.#within(time),
    ) as Span;
    const [first, last] = this.held ?? [start, end];
    // Without a kernel, a selection outside of the page's data is replaced by these data.
    return start < last && end > first ? [Math.max(start, first), Math.min(end, last)] : [first, last];
  }

  /** The span that the page has, if no more data will come; else null. */
  get held(): Span | null {
    const held = lacksKernel(this.#model) ? this.#segments.span : null;
    return held && [this.#within(held[0]), this.#within(held[1])];
  }

  /** Calls back on every change of the player, until the signal aborts. */
  listen(callback: () => void, signal: AbortSignal): void {
    this.#listeners.add(callback);
    onAbort(signal, () => this.#listeners.delete(callback));
  }

  toggle(): void {
    setTraits(this.#model, { playing: !this.playing, time: this.#time });
  }

  seek(time: number): void {
    this.#goTo(time, false);
  }

  /** Follows another player; without the same place here, the moment on show stays. */
  #goToPlace(time: number, isSent: boolean): void {
    this.#isLost = Number.isNaN(time);
    if (this.#isLost) this.#changed();
    else if (time !== this.#time && isSent) this.#take(this.#within(time));
    else if (time !== this.#time) this.seek(time);
  }

  #goTo(time: number, isStep: boolean): void {
    this.#time = this.#within(time);
    this.#movesFrozen = isStep;
    this.#pointed = null;
    this.#wished = null;
    this.#show();
    if (!this.#lacks) {
      this.#tell();
      return;
    }
    // Request the missing segment first: Python takes a while to follow the new time.
    this.#prefetcher.ask(this.#time);
    setTraits(this.#model, { time: this.#time });
  }

  /** Notes the time under the pointer, which the user may click next; null without one. */
  point(time: number | null): void {
    this.#prefetcher.point(time === null ? null : this.#within(time));
  }

  /** Shows the moment under the pointer in all widgets, until it is null; the time stays. Playing goes on. */
  preview(pointed: Pointing["_pointed"]): void {
    this.point(pointed?.time ?? null);
    this.#pointed = pointed && !this.playing ? { ...pointed, time: this.#within(pointed.time) } : null;
    this.#show();
  }

  /** Steps to the next or previous frame of the first widget: a laser, if there is one. */
  step(direction: -1 | 1): void {
    if (this.playing) setTraits(this.#model, { playing: false });
    this.#wished = [this.#frozenAt ?? this.#time, direction];
    this.#takeStep();
    if (!this.#wished) return;
    // Across a long silence only Python knows the next sample. While it is busy, the segments may come before its answer.
    this.#model.send({ step: this.#wished });
    this.#changed();
  }

  /** Takes the wanted step if the page has the data for it. */
  #takeStep(): void {
    const to = this.#wished && this.#segments.neighbour(0, ...this.#wished, this.duration);
    if (to !== null) this.#goTo(to, true);
  }

  /** Marks, and spans that have a name, by their starts. */
  get marks(): Mark[] {
    const [marks, labels] = [this.#model.get("marks"), this.#model.get("labels")];
    if (!labels.length) return marks;
    const [ofMarks, ofLabels] = this.#joined.of;
    // The same array while both are the same: there may be thousands, and this runs in every frame while it plays.
    if (ofMarks !== marks || ofLabels !== labels) {
      const named = labels.map(([start, end, name]): Mark => [start, end, `\u201c${name}\u201d`]);
      this.#joined = { of: [marks, labels], marks: [...marks, ...named].sort(([a], [b]) => a - b) };
    }
    return this.#joined.marks;
  }

  /** Goes to the start of the next mark, or of the previous one. */
  toMark(direction: -1 | 1): void {
    const found = markBeside(this.marks, this.#time, direction);
    if (found !== undefined) this.seek(found);
  }

  #onTime(): void {
    const apart = Math.abs(this.#model.get("time") - this.#time);
    if (apart === 0 || (this.playing && apart < APART * this.#model.get("speed"))) return;
    this.#take(this.#model.get("time"));
  }

  /** Goes to a time that Python has. */
  #take(time: number): void {
    this.#time = time;
    // In a page that draws seldom: the time since its last picture is in it.
    this.#last = performance.now();
    this.#wished = null;
    this.#movesFrozen = false;
    this.#show();
  }

  #onPlaying(): void {
    this.#last = performance.now();
    if (this.playing) {
      this.#pointed = null;
      this.#wished = null;
      const [start, end] = this.span;
      if (this.#time < start || this.#time >= end) this.seek(start);
      this.#nextFrame();
    }
    this.#changed();
  }

  #advance(): void {
    if (!this.playing) return;
    const now = performance.now();
    const passed = (now - this.#last) / 1000;
    this.#last = now;
    const [start, end] = this.span;
    const before = this.#time;
    // Wait for missing segments instead of skipping them.
    if (!this.#lacks) this.#time += passed * this.#model.get("speed");
    if (this.#time >= end) {
      const again = this.#model.get("loop");
      this.#time = again ? start : end;
      if (!again) setTraits(this.#model, { playing: false, time: end });
    }
    if (this.#time !== before) this.#tell();
    this.#show();
    this.#nextFrame();
  }

  #onMessage({ seek, step, segment, drop = [], abouts = [] }: Message, buffers: DataView[]): void {
    if (seek !== undefined) {
      // A late answer to a step that was taken meanwhile, or replaced by another one, leads nowhere.
      if (!step || step.join() === this.#wished?.join()) this.#goTo(seek, Boolean(step));
      return;
    }
    // A message for another part of the page, such as the answer to a name.
    if (segment === undefined) return;
    const tracks = buffers.map((buffer, i): Track => {
      return { frames: decodeFrames(toBytes(buffer) as DataView), abouts: abouts[i] ?? [] };
    });
    this.#segments.drop(drop);
    this.#segments.put(segment, tracks);
    this.#prefetcher.came();
    this.#takeStep();
    // The segment on show may have been replaced.
    this.#show();
  }

  #show(): void {
    const time = this.shown;
    const frames = this.#segments.at(time);
    this.#lacks = frames === null;
    this.#isGiving = true;
    if (frames) {
      this.#targets.show(frames, time, this.#model.get("_pauses"));
      if (this.#movesFrozen) this.#holdFrozen(frames);
      this.#targets.giveRecent(this.#segments, time, this.#frozenAt);
    } else {
      this.#targets.wait();
    }
    this.#isGiving = false;
    this.#showRay();
    for (const follower of this.#followers) {
      if (follower.get("time") !== this.#time) this.#give(follower);
      const moment = this.#pointed && !follower.get("_pointed") ? time : null;
      if ((follower.get("_moment") ?? null) !== moment) follower.set("_moment", moment);
    }
    // For players that follow this one; Python gets it with the next time.
    this.#model.set("_shown", this.#frozenAt ?? time);
    this.#changed();
  }

  /** Keeps frozen widgets at one moment, from which steps go on. */
  #watchFreezing(target: Host<Target>, signal: AbortSignal): void {
    const onPaused = () => {
      const isFrozen = this.#targets.models.some((other) => other.get("paused"));
      this.#frozenAt = isFrozen ? (this.#frozenAt ?? this.shown) : null;
      this.#show();
    };
    onPaused();
    onChange(target, ["paused"], onPaused, signal);
  }

  /** Goes to the time of a place of the path that is clicked. */
  #watchPicking(target: Host<Target>, signal: AbortSignal): void {
    const onPicked = () => {
      const time = target.get("_picked");
      // Reset, so that the same place can be picked again.
      give(target, { _picked: null });
      if (typeof time === "number") this.seek(time);
    };
    onPicked();
    onChange(target, ["_picked"], onPicked, signal);
  }

  /** Shows a moment on frozen widgets after a step; they stay frozen. */
  #holdFrozen(frames: Shown[]): void {
    this.#movesFrozen = false;
    if (this.#frozenAt === null) return;
    this.#frozenAt = this.#time;
    this.#targets.hold(frames);
  }

  /** Shows the ray of the ring on the scanogram on the laser. */
  #showRay(): void {
    const ray = this.#previewed?.ray ?? null;
    const [laser] = this.#targets.models;
    if (ray === this.#ray && (ray === null || laser?.get("hovered") === ray)) return;
    this.#ray = ray;
    if (laser) give(laser, { hovered: ray });
  }

  /** Follows the time and the selection that the user sets on another widget, and gives it the selection of the player. */
  #follow(follower: Follower, signal: AbortSignal): void {
    const onTime = () => {
      if (this.#isGiving) return;
      const time = follower.get("time");
      // A change from the kernel, which is a click in another page or an old value, is ignored: the time of the player
      // has it, too. A plot has no time after Escape; a player always has one.
      if (follower._state_lock || time === null) this.#give(follower);
      else if (time !== this.#time) this.seek(time);
    };
    const laser = this.#targets.models[0];
    const onPoint = () => this.preview(follower.get("_pointed") ?? null);
    const onRay = () => {
      const hovered = laser?.get("hovered") ?? null;
      give(follower, { _ray: hovered === this.#ray ? null : hovered });
    };
    const onSelection = () => {
      const selection = follower.get("selection");
      // After the other widget has sent its own change, so that Python need not correct it.
      queueMicrotask(() => setTraits(this.#model, { selection: selection && ([selection[0], selection[1]] as Span) }));
    };
    const onOwnSelection = () => {
      // Python gives its own changes to both.
      if (this.#model._state_lock) return;
      const [own, other] = [this.#model.get("selection"), follower.get("selection")];
      if (other === undefined || (own?.[0] === other?.[0] && own?.[1] === other?.[1])) return;
      // Before the player sends its change: Python would correct the other widget, which may have changed again by then.
      follower.set("selection", own);
      follower.save_changes();
    };
    onChange(follower, ["time"], onTime, signal);
    onChange(follower, ["_pointed"], onPoint, signal);
    onChange(follower, ["selection"], onSelection, signal);
    onChange(this.#model, ["selection"], onOwnSelection, signal);
    if (laser) onChange(laser, ["hovered"], onRay, signal);
  }

  /** Sets the time of a widget; nothing is sent to the kernel. */
  #give(follower: Follower): void {
    this.#isGiving = true;
    give(follower, { time: this.#time });
    this.#isGiving = false;
  }

  #within(time: number): number {
    return Math.min(Math.max(this.begin, time), this.duration);
  }

  #changed(): void {
    for (const listener of this.#listeners) listener();
  }
}
