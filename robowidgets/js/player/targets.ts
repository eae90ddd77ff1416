import { toBytes } from "../shared/bytes.ts";
import type { About } from "../shared/traits.ts";
import { give, type Host, type Target } from "./moved.ts";
import type { Segments, Shown } from "./segments.ts";

/** Samples that are given at most. */
const MOST = 600;

/** The models of the widgets that show frames, and the frame of each. */
export class Targets {
  readonly models: Host<Target>[];
  #abouts: About[] = [];
  #ages: number[] = [];
  #isWaiting = false;

  constructor(models: Host<Target>[]) {
    this.models = models;
  }

  /**
   * Shows a frame on each widget whose frame or age has changed. A page whose connection was lost gets
   * the frames that Python has, which may be of another moment.
   *
   * @param pauses seconds after which the sample of each widget is old, or 0 for never
   */
  show(frames: Shown[], time: number, pauses: number[]): void {
    for (const [i, { track, frame }] of frames.entries()) {
      const target = this.models[i];
      if (!target) continue;
      const age = frame.time < 0 ? 0 : toAge(time - frame.time, pauses[i]);
      const shown = toBytes(target.get("_frame"));
      const isNew = shown !== frame.bytes;
      if (!isNew && this.#ages[i] === age && target.get("_about") === this.#abouts[i]) continue;
      this.#ages[i] = age;
      const about: About = { ...track.abouts[frame.about], ...(age && { age }) };
      const state: Partial<Target> = { _about: about };
      if (isNew) {
        // Count up, so that a frozen widget shows the number of frames since.
        const number = shown?.byteLength ? shown.getFloat64(0, true) + 1 : 1;
        frame.bytes.setFloat64(0, number, true);
        state._frame = frame.bytes;
      }
      // The verdicts in a history belong to its frames, which have new numbers.
      if (about.judged !== undefined) about.judged = frame.bytes.getFloat64(0, true);
      this.#abouts[i] = about;
      give(target, state);
    }
    this.#isWaiting = false;
  }

  /** Marks the frames on show as frames of another moment, until the next are shown. */
  wait(): void {
    if (this.#isWaiting) return;
    this.#isWaiting = true;
    for (const [i, target] of this.models.entries()) {
      if (this.#abouts[i]) give(target, { _about: { ...target.get("_about"), waits: true } });
    }
  }

  /** Shows frames on the widgets that are frozen, which stay so. */
  hold(frames: Shown[]): void {
    for (const [i, target] of this.models.entries()) {
      const bytes = frames[i]?.frame.bytes;
      if (!bytes || !target.get("paused")) continue;
      target.set("_frozen_frame", bytes);
      target.save_changes();
    }
  }

  /** Gives the last frames up to the one on show to widgets that show earlier samples or numbers over time. */
  giveRecent(segments: Segments, time: number, frozenAt: number | null): void {
    for (const [i, target] of this.models.entries()) {
      const before = target.get("_recent");
      const scans = Math.max(target.get("trail") ?? 0, (target.get("spread") ?? 0) - 1);
      const count = target.get("_about").numbers ? MOST : Math.max(scans, target.get("_needs") ?? 0);
      if (!before && count <= 0) continue;
      const found = segments.upTo(i, (target.get("paused") ? frozenAt : null) ?? time, count + 1);
      const isSame = found.length === before?.length && found.every(({ frame }, j) => frame.bytes === before[j]?.bytes);
      if (isSame) continue;
      give(target, {
        _recent: found.map(({ track, frame }) => ({
          ...frame,
          at: 1000 * frame.time,
          about: track.abouts[frame.about] ?? {},
        })),
      });
    }
  }
}

/** Milliseconds since the newest sample, in tenths of a second, if that is longer than a pause; else 0. */
function toAge(seconds: number, pause = 0): number {
  return pause && seconds > pause ? Math.floor(seconds * 10) * 100 : 0;
}
