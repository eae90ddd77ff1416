import assert from "node:assert/strict";
import { test } from "node:test";
import { decodeSpeeds, type Speeds } from "../../robowidgets/js/shared/frames/speeds.ts";
import { type AxisFacts, decimalsFor, hasPeaks, toFacts, toFastest } from "../../robowidgets/js/speed/facts.ts";
import {
  describeAxis,
  stateWords,
  summarize,
  toNumber,
  toShort,
  toValueText,
} from "../../robowidgets/js/speed/text.ts";
import type { Limits } from "../../robowidgets/js/speed/traits.ts";
import { frameOf } from "./vectors.ts";

const NONE = [NaN, NaN, NaN, NaN, NaN, NaN];
const SETTINGS = {
  limits: { linear: [-1, 1] as Limits, angular: [-1, 1] as Limits, axes: {} },
  planar: false,
  marksPeaks: false,
  fastest: { linear: 0, angular: 0, steering: 0 },
};
const NO_LIMITS = { ...SETTINGS, limits: { linear: null, angular: null, axes: {} } };

function speeds(more: Partial<Speeds>): Speeds {
  const none = { measured: null, commanded: null, least: NONE, greatest: NONE, resets: 0 };
  return { sequence: 1, rate: NaN, arrived: 0, ...none, ...more };
}

function axisFacts(index: number, more: Partial<Speeds>, settings = {}): AxisFacts {
  const facts = toFacts(speeds(more), { ...SETTINGS, ...settings }).flatMap(({ axes }) => axes);
  const found = facts.find(({ axis }) => axis.index === index);
  assert.ok(found);
  return found;
}

function summary(measured: number[], planar = false): string {
  const groups = toFacts(speeds({ measured }), { ...SETTINGS, planar });
  return summarize(
    groups.flatMap(({ axes }) => axes),
    groups.flatMap(({ hidden }) => hidden),
  );
}

test("a value before the first sample is null, and not NaN", () => {
  const bytes = frameOf("speed");
  const there = 32;
  bytes.setFloat64(there, 1, true);
  assert.equal(decodeSpeeds(bytes).commanded, null);
  bytes.setFloat64(there, 2, true);
  assert.equal(decodeSpeeds(bytes).measured, null);
});

test("numbers have two decimals, and more if all limits are small", () => {
  const cases: [Limits[], number][] = [
    [[[-1, 1]], 2],
    [[[-0.1, 0.1]], 2],
    [[[0, 0.05]], 3],
    [
      [
        [0, 0.05],
        [-1, 1],
      ],
      2,
    ],
    [[[-0.002, 0.001]], 4],
    [[[-1e-9, 1e-9]], 6],
    [[[-130, 2]], 2],
  ];
  for (const [limits, decimals] of cases) assert.equal(decimalsFor(limits), decimals, `${limits}`);
});

test("a number keeps its decimals until it would be wider than its column", () => {
  const cases: [number, string][] = [
    [0.624, "0.62"],
    [-1.24, "−1.24"],
    [-0.001, "0.00"],
    [-99.994, "−99.99"],
    [123.456, "123.5"],
    [12345.678, "12346"],
    [-1e9, "−1.0e9"],
    [-1e-9, "0.00"],
    [Infinity, "+inf"],
    [-Infinity, "−inf"],
  ];
  for (const [value, text] of cases) assert.equal(toNumber(value, 2), text);
});

test("NaN is shown as no value, and a missing measurement is not shown as zero", () => {
  assert.equal(toValueText(NaN, 2), "no value");
  assert.equal(toValueText(null, 2), "–");
  assert.equal(toValueText(0, 2), "0.00");
});

test("limits are written with the decimals they need and a real minus", () => {
  assert.deepEqual([1, -0.22, 0.1 + 0.2, 0, 1e-9].map(toShort), ["1", "−0.22", "0.3", "0", "1e−9"]);
});

test("a state past a limit has a mark and words", () => {
  assert.deepEqual(stateWords("over"), ["▲", "over", "limit"]);
  assert.deepEqual(stateWords("under"), ["▼", "under", "limit"]);
  assert.deepEqual(stateWords("within"), ["", "", ""]);
  assert.deepEqual(stateWords("under", [-1, 1]), ["▼", "over", "limit"], "too fast to the other side");
  assert.deepEqual(stateWords("under", [0.1, 1]), ["▼", "under", "limit"], "too slow");
});

test("the pop-up has the exact values of an axis", () => {
  const words = describeAxis(
    axisFacts(
      5,
      {
        measured: [0, 0, 0, 0, 0, -1.234567],
        commanded: [0, 0, 0, 0, 0, -0.5],
        least: [0, 0, 0, 0, 0, -1.5],
        greatest: [0, 0, 0, 0, 0, 0.25],
      },
      { marksPeaks: true },
    ),
  );
  assert.deepEqual(words, {
    expression: "yaw (angular.z)",
    direction: "right",
    value: "−1.2346 rad/s",
    alarm: "over the limit of 1",
    details: [
      ["limits", "−1 to 1"],
      ["commanded", "−0.5000"],
      ["least", "−1.5000 over the limit of 1"],
      ["greatest", "0.2500"],
    ],
  });
});

test("the pop-up reports that a bar is longer than the scale", () => {
  const words = describeAxis(axisFacts(0, { measured: [Infinity, 0, 0, 0, 0, 0] }));
  assert.equal(words.value, "+inf m/s");
  assert.equal(words.alarm, "over the limit of 1, off the scale");
});

test("the pop-up of an axis without a value reports it, and has no direction", () => {
  const { value, direction, alarm } = describeAxis(axisFacts(1, { measured: NONE }));
  assert.deepEqual([value, direction, alarm], ["no value", "", ""]);
});

test("the pop-up of a command alone reports that nothing was measured", () => {
  const { value, details } = describeAxis(axisFacts(0, { commanded: [2, 0, 0, 0, 0, 0] }));
  assert.equal(value, "not measured");
  assert.deepEqual(details[1], ["commanded", "2.0000 over the limit of 1"]);
});

test("a positive speed has the direction of REP-103", () => {
  const positive = [0, 1, 2, 3, 4, 5].map(
    (i) => describeAxis(axisFacts(i, { measured: NONE.map(() => 0.5) })).direction,
  );
  assert.deepEqual(positive, ["forward", "left", "up", "rolls right", "nose down", "left"]);
  const still = describeAxis(axisFacts(0, { measured: [0.00001, 0, 0, 0, 0, 0] }));
  assert.equal(still.direction, "");
});

test("one line names the axes past their limits", () => {
  assert.equal(summary([0.5, 0, 0, 0, 0, 0]), "within limits");
  assert.equal(summary([1.5, 0, 0, 0, 0, -2]), "x over the limit of 1, yaw over the limit of 1");
  assert.equal(summary([1.5, 2, 0, 0, 0, -2]), "3 past their limits");
  assert.equal(summary(NONE), "");
  assert.equal(summarize([], []), "");
});

test("without limits, speeds are never past them, and limits are not mentioned", () => {
  const measured = [3, 0, 0, 0, 0, -20];
  const fastest = toFastest(speeds({ measured }), false, SETTINGS.fastest);
  const words = describeAxis(axisFacts(0, { measured }, { ...NO_LIMITS, fastest }));
  assert.deepEqual([words.value, words.alarm, words.details], ["3.0000 m/s", "", []]);
  const groups = toFacts(speeds({ measured }), { ...NO_LIMITS, fastest });
  assert.equal(
    summarize(
      groups.flatMap(({ axes }) => axes),
      groups.flatMap(({ hidden }) => hidden),
    ),
    "",
  );
  assert.deepEqual(
    groups.map(({ scale, shared }) => [scale, shared]),
    [
      [{ low: -6.25, high: 6.25 }, null],
      [{ low: -25, high: 25 }, null],
    ],
  );
  const infinite = describeAxis(axisFacts(0, { measured: [Infinity, 0, 0, 0, 0, 0] }, NO_LIMITS));
  assert.equal(infinite.alarm, "off the scale");
});

test("the fastest speed counts commands and peaks of the axes on show, and never falls", () => {
  const more = { measured: [0.1, 0, 9, 0, 0, NaN], commanded: [-0.4, 0, 0, 0, 0, 0], greatest: [0, 0, 0, 0, 0, 2] };
  const fastest = toFastest(speeds(more), true, SETTINGS.fastest);
  assert.deepEqual(fastest, { linear: 0.4, angular: 2, steering: 0 });
  assert.deepEqual(toFastest(speeds({ measured: [0, 0, 0, 0, 0, -Infinity] }), true, fastest), fastest);
  assert.equal(toFastest(speeds(more), false, SETTINGS.fastest).linear, 9);
});

test("a hidden axis that moves or passes its limit is named", () => {
  assert.equal(summary([0, 0, 0.25, 0.001, NaN, 0], true), "within limits · not shown: z 0.25");
  assert.equal(summary([0, 0, 1.5, 0, 0, 0], true), "z over the limit of 1 · not shown: z 1.50");
});

test("planar shows linear x and y and angular z, on scales of their limits alone", () => {
  const limits = { ...SETTINGS.limits, axes: { "linear.z": [-9, 9] as Limits } };
  const [linear, angular] = toFacts(null, { ...SETTINGS, limits, planar: true });
  assert.deepEqual(
    [linear, angular].map((group) => group?.axes.map(({ axis }) => axis.name)),
    [["linear.x", "linear.y"], ["angular.z"]],
  );
  assert.deepEqual(linear?.scale, { low: -1.25, high: 1.25 });
});

test("peaks are shown only if they are enabled", () => {
  const more = { measured: NONE, least: [1, 1, 1, 1, 1, 1], greatest: [2, 2, 2, 2, 2, 2] };
  assert.equal(axisFacts(0, more).peaks, null);
  assert.deepEqual(axisFacts(0, more, { marksPeaks: true }).peaks, [1, 2]);
});

test("peaks are known once a speed was measured, and never in a player, whose frames have none", () => {
  assert.equal(hasPeaks(null), false);
  assert.equal(hasPeaks(speeds({ measured: [1, 0, 0, 0, 0, 0], least: NONE, greatest: NONE })), false);
  assert.equal(hasPeaks(speeds({ measured: NONE, least: [NaN, NaN, NaN, NaN, NaN, 0] })), true);
});

test("a car shows its steering angle, and alone only the axes that it has", () => {
  const steered = [1.5, NaN, NaN, NaN, NaN, NaN, -0.25];
  const names = (more: Partial<Speeds>) =>
    toFacts(speeds(more), { ...SETTINGS, planar: true }).map(({ axes }) => axes.map(({ axis }) => axis.name));
  assert.deepEqual(names({ measured: steered }), [["linear.x"], ["steering"]]);
  assert.deepEqual(names({ commanded: steered }), [["linear.x"], ["steering"]]);
  const moving = [1, 0, 0, 0, 0, 0.1, NaN];
  assert.deepEqual(names({ measured: moving, commanded: steered }), [
    ["linear.x", "linear.y"],
    ["angular.z"],
    ["steering"],
  ]);
  assert.deepEqual(names({ measured: moving }), [["linear.x", "linear.y"], ["angular.z"]]);
  const { expression, direction, value } = describeAxis(axisFacts(6, { measured: steered }));
  assert.deepEqual([expression, direction, value], ["angle (steering)", "right", "−0.2500 rad"]);
});
