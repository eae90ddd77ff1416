import assert from "node:assert/strict";
import { test } from "node:test";
import type { Sensor } from "../../robowidgets/js/shared/frames/touch.ts";
import { Clock } from "../../robowidgets/js/touch/clock.ts";
import { select } from "../../robowidgets/js/touch/select.ts";
import {
  detailOf,
  modeWord,
  summarize,
  tellAll,
  tellBeside,
  toDuration,
  toLabels,
  toShared,
} from "../../robowidgets/js/touch/text.ts";

const LEFT: Sensor = { name: "left", state: "free", touches: 3, seconds: 2 };
const CENTER: Sensor = { name: "center", state: "touched", touches: 1, seconds: 0.5 };
const RIGHT: Sensor = { name: "right", state: "unknown", touches: 0, seconds: null };

test("a selection keeps its order, and a sensor without a message is unknown", () => {
  assert.deepEqual(select([LEFT, CENTER], ["center", "tail"]), [
    CENTER,
    { name: "tail", state: "unknown", touches: 0, seconds: null },
  ]);
  assert.deepEqual(select([LEFT, CENTER], []), [LEFT, CENTER]);
});

test("sensors that differ in their side stand from left to right, in any order of arrival", () => {
  const order = (...names: string[]) =>
    select(
      names.map((name) => ({ ...LEFT, name })),
      [],
    ).map(({ name }) => name);
  assert.deepEqual(order("right", "left"), ["left", "right"]);
  assert.deepEqual(order("center", "right", "left"), ["left", "center", "right"]);
  assert.deepEqual(order("Right", "Centre", "Left"), ["Left", "Centre", "Right"]);
  const cliffs = ["cliff left", "bump", "right", "cliff right", "left", "button 0"];
  assert.deepEqual(order(...cliffs), ["cliff left", "bump", "left", "cliff right", "right", "button 0"]);
  const create = ["bump_left", "bump_front_left", "bump_front_center", "bump_front_right", "bump_right"];
  assert.deepEqual(order(...create), create);
});

test("the text names a touched sensor that is not on show", () => {
  assert.equal(tellBeside([LEFT, CENTER, RIGHT], [LEFT]), "also touched: center");
  assert.equal(tellBeside([LEFT, CENTER, RIGHT], [CENTER]), "");
});

test("durations are read at a glance", () => {
  const said = [0, 0.04, 1.24, 59.94, 59.96, 60, 65, 3599.4, 3599.6, 7620].map(toDuration);
  assert.deepEqual(said, [
    "0.0 s",
    "0.0 s",
    "1.2 s",
    "59.9 s",
    "1 min 00 s",
    "1 min 00 s",
    "1 min 05 s",
    "59 min 59 s",
    "1 h 00 min",
    "2 h 07 min",
  ]);
});

test("a touch shows its duration, the others their number of touches", () => {
  assert.equal(detailOf(CENTER, 0.7), "1.2 s");
  assert.equal(detailOf(LEFT, 0.7), "3 touches");
  assert.equal(detailOf({ ...LEFT, touches: 1 }, 0), "1 touch");
  assert.equal(detailOf({ ...LEFT, touches: 0 }, 0), "0 touches");
  assert.equal(detailOf(RIGHT, 0), "\u2014");
  assert.equal(detailOf({ ...RIGHT, touches: 2 }, 0), "2 touches");
});

test("without a known age of a state, its duration is left out", () => {
  assert.equal(detailOf(CENTER, null), "1 touch");
});

test("all facts about a sensor are one sentence", () => {
  assert.equal(tellAll(CENTER, 1), "center: touched for 1.5 s, 1 touch so far");
  assert.equal(tellAll(RIGHT, 1), "right: not known yet, 0 touches so far");
  assert.equal(tellAll(CENTER, null), "center: touched, 1 touch so far");
});

test("the summary counts sensors by state and all touches", () => {
  assert.deepEqual(summarize([LEFT, CENTER, RIGHT]), { counts: { touched: 1, free: 1, unknown: 1 }, touches: 4 });
});

test("unknown modes have no text", () => {
  assert.deepEqual(["event", "level", "presence", "loud", undefined].map(modeWord), [
    "events",
    "level",
    "presence",
    "",
    "",
  ]);
});

test("names in scopes are cut to the parts that distinguish them", () => {
  const names = ["bot::base::collision", "bot::arm::collision", "bot::arm::finger", "left"];
  assert.deepEqual(toLabels(names, {}), ["base::collision", "arm::collision", "finger", "left"]);
  assert.deepEqual(toLabels(["a::b", "b"], {}), ["a::b", "b"]);
});

test("labels leave out the words that all names share at their start or end", () => {
  const bumpers = ["left", "front_left", "right"].map((place) => `bumper_sensor_${place}_link`);
  assert.deepEqual(toLabels(bumpers, {}), ["left", "front_left", "right"]);
  assert.deepEqual(toLabels(["left bumper", "right bumper"], {}), ["left", "right"]);
  assert.deepEqual(toLabels(["bumper", "bumper_2"], {}), ["bumper", "bumper_2"], "a word of each is left");
  assert.deepEqual(toLabels(["bump_1", "bump_12", "bump_2"], {}), ["1", "12", "2"]);
  assert.deepEqual(toLabels(["bumperleft", "bumperright"], {}), ["bumperleft", "bumperright"], "whole words alone");
  assert.deepEqual(toLabels(["bumper_left"], {}), ["bumper_left"], "one shares nothing");
  assert.deepEqual(toLabels(["cliff left", "cliff right", "wheel left"], {}), [
    "cliff left",
    "cliff right",
    "wheel left",
  ]);
  const robots = ["robot::base::bumper_left", "robot::base::bumper_right"];
  assert.deepEqual(toLabels(robots, { [robots[0] as string]: "Nose" }), ["Nose", "right"]);
});

test("a given label is used as it is, even an empty one", () => {
  assert.deepEqual(toLabels(["a::b", "c"], { "a::b": "<b>nose</b>", c: "" }), ["<b>nose</b>", ""]);
});

/** A stream whose arrivals and freezing the test controls. */
class FakeStream {
  paused = false;
  arrived = 0;
  stepped = false;
  #callback = () => {};

  listen(callback: () => void): void {
    this.#callback = callback;
  }

  set(values: { paused?: boolean; arrived?: number; stepped?: boolean }): void {
    Object.assign(this, values);
    this.#callback();
  }
}

function startClock(values: Partial<FakeStream> = {}) {
  const stream = Object.assign(new FakeStream(), values);
  const time = { now: 1000 };
  return { stream, time, clock: new Clock(stream, new AbortController().signal, () => time.now) };
}

test("a frame that is stepped to has the age of its arrival", () => {
  const { stream, time, clock } = startClock();
  stream.set({ arrived: 1000 });
  time.now = 3000;
  stream.set({ paused: true });
  assert.equal(clock.elapsed, 2);
  stream.set({ stepped: true });
  assert.equal(clock.elapsed, 0);
  stream.set({ paused: false, stepped: false });
  assert.equal(clock.elapsed, 2);
});

test("a state found at page load has no known age", () => {
  const { time, clock } = startClock();
  time.now = 60_000;
  assert.equal(clock.elapsed, null);
  assert.equal(clock.runs, false);
});

test("the clock shows the age of the newest frame", () => {
  const { stream, time, clock } = startClock();
  stream.set({ arrived: 1000 });
  time.now = 2500;
  assert.equal(clock.elapsed, 1.5);
  assert.equal(clock.runs, true);
  stream.set({ arrived: 2500 });
  assert.equal(clock.elapsed, 0);
});

test("the clock stands still while frozen, also as frames arrive, and runs on from the newest", () => {
  const { stream, time, clock } = startClock();
  stream.set({ arrived: 1000 });
  time.now = 1400;
  stream.set({ paused: true });
  time.now = 5000;
  stream.set({ arrived: 5000 });
  time.now = 5500;
  assert.equal(clock.elapsed, 0.4);
  assert.equal(clock.runs, false);
  stream.set({ paused: false });
  assert.equal(clock.elapsed, 0.5);
});

test("a page that opens on a frozen picture keeps its times", () => {
  const { stream, time, clock } = startClock({ paused: true });
  time.now = 9000;
  stream.set({ arrived: 9000 });
  time.now = 9900;
  assert.equal(clock.elapsed, null);
});

test("the words that more than four names share are shown once", () => {
  const names = Array.from({ length: 14 }, (_, i) => `robot::base::bumper_${i}_contact`);
  assert.equal(toShared(names, toLabels(names, {})), "robot::base::bumper_\u2026_contact");
  assert.equal(toShared(names.slice(0, 4), toLabels(names.slice(0, 4), {})), "", "a few names are short enough");
  const given = toLabels(names, { [names[3] as string]: "Nose" });
  assert.equal(toShared(names, given), "", "a label that is given");
  const plain = ["left", "center", "right", "front", "back"];
  assert.equal(toShared(plain, toLabels(plain, {})), "");
});
