import assert from "node:assert/strict";
import { test } from "node:test";
import { groupsOf } from "../../robowidgets/js/speed/axes.ts";
import { judge, limitsOf } from "../../robowidgets/js/speed/limits.ts";
import { placeBeside } from "../../robowidgets/js/speed/popup.ts";
import {
  CLEARANCE,
  isOff,
  scaleLabels,
  sharedLimits,
  toClearance,
  toHeight,
  toHeightOnTrack,
  toReach,
  toScales,
} from "../../robowidgets/js/speed/scale.ts";
import type { Limits } from "../../robowidgets/js/speed/traits.ts";

import { toNumber, vectors } from "./vectors.ts";

const ONE: Limits = [-1, 1];

function near(actual: number, expected: number): void {
  assert.ok(Math.abs(actual - expected) < 1e-12, `${actual} is not ${expected}`);
}

test("limits of one and one leave an eighth of their span beyond each", () => {
  const [scale] = toScales([[ONE, ONE, ONE]]);
  assert.deepEqual(scale, { low: -1.25, high: 1.25 });
});

test("a scale holds the limits of each of its axes", () => {
  const [scale] = toScales([[[-0.2, 0.5], ONE, [-3, 2]]]);
  assert.ok(scale && scale.low < -3 && scale.high > 2);
});

test("zero lies at the same height in all groups, and each holds its limits", () => {
  for (const groups of [
    [[[-0.2, 0.5]], [ONE]],
    [[[0, 0.5]], [[-1, 0]]],
    [[[-1000, 0.001]], [[-0.001, 7]]],
  ] as Limits[][][]) {
    const scales = toScales(groups);
    const [first, second] = scales.map((scale) => toHeight(scale, 0));
    near(first ?? 0, second ?? 1);
    for (const [g, limits] of groups.entries()) {
      for (const limit of limits.flat()) {
        const height = toHeight(scales[g] ?? { low: 0, high: 0 }, limit);
        assert.ok(height > 0 && height < 1, `${limit} at ${height}`);
      }
    }
  }
});

test("a group whose limits are alike on both sides as the others' uses all of the track", () => {
  const [linear, angular] = toScales([[[-0.22, 0.22]], [[-2.84, 2.84]]]);
  near(toHeight(linear ?? { low: 0, high: 1 }, 0.22), 0.9);
  near(toHeight(angular ?? { low: 0, high: 1 }, 2.84), 0.9);
});

test("a limit of zero leaves room below zero for a speed that passes it", () => {
  const [scale] = toScales([[[0, 0.5]]]);
  assert.deepEqual(scale, { low: -0.0625, high: 0.5625 });
});

test("without limits a scale reaches to the next round number that holds the fastest speed", () => {
  const reaches = [0, 0.0004, 0.1, 0.22, 0.3, 0.5, 1, 1.2, 2.84, 20, 51, 1e9].map(toReach);
  assert.deepEqual(reaches, [0.1, 0.1, 0.1, 0.5, 0.5, 0.5, 1, 2, 5, 20, 100, 1e6]);
});

test("a speed off the scale is drawn at its end and marked as off", () => {
  const scale = { low: -1.25, high: 1.25 };
  assert.equal(toHeightOnTrack(scale, 2), 1);
  assert.equal(toHeightOnTrack(scale, -Infinity), 0);
  assert.deepEqual(
    [1.25, 1.2501, -1.3, Infinity, NaN].map((v) => isOff(v, scale)),
    [false, true, true, true, false],
  );
});

test("a value is past a limit by more than rounding, and NaN is neither", () => {
  for (const [value, limits, state] of vectors.limits) assert.equal(judge(toNumber(value), limits), state, `${value}`);
});

test("an axis has its own limits, else the limits of its group", () => {
  const settings = { linear: [-2, 2] as Limits, angular: [-3, 3] as Limits, axes: { "angular.z": [0, 1] as Limits } };
  const found = groupsOf("velocity").flatMap((group) => group.axes.map((axis) => limitsOf(settings, group, axis)));
  assert.deepEqual(found, [
    [-2, 2],
    [-2, 2],
    [-2, 2],
    [-3, 3],
    [-3, 3],
    [0, 1],
  ]);
});

test("limits are shared if they are the same for all", () => {
  assert.deepEqual(sharedLimits([ONE, [-1, 1]]), ONE);
  assert.equal(sharedLimits([ONE, [-1, 2]]), null);
  assert.equal(sharedLimits([null, null]), null);
  assert.equal(sharedLimits([ONE, null]), null);
});

test("the numbers next to the tracks are the limits, zero, and round ones between", () => {
  const labels = scaleLabels({ low: -1.25, high: 1.25 }, ONE, CLEARANCE);
  assert.deepEqual(
    labels.map(({ value, round }) => [value, round]),
    [
      [-1, false],
      [1, false],
      [0, false],
      [-0.5, true],
      [0.5, true],
    ],
  );
});

test("the numbers next to the tracks never touch", () => {
  for (const limits of [
    [-2.84, 2.84],
    [-0.001, 130],
    [-7, 0.4],
    [0, 0.02],
  ] as Limits[]) {
    const [scale] = toScales([[limits], [ONE]]);
    const labels = scaleLabels(scale ?? { low: 0, high: 1 }, limits, CLEARANCE);
    const heights = labels.map(({ height }) => height).sort((a, b) => a - b);
    for (const [i, height] of heights.slice(1).entries()) {
      const gap = height - (heights[i] ?? 0);
      assert.ok(gap >= CLEARANCE, `${limits}: ${gap}`);
    }
    for (const limit of limits)
      assert.ok(
        labels.some(({ value }) => value === limit),
        `${limit} is labelled`,
      );
  }
});

test("on a low track only numbers that have room stay", () => {
  const values = (pixels: number) =>
    scaleLabels({ low: -1.25, high: 1.25 }, null, toClearance(pixels)).map(({ value }) => value);
  assert.deepEqual(values(200), [0, -1, -0.5, 0.5, 1]);
  assert.deepEqual(values(48), [0, -1, 1]);
  assert.deepEqual(values(0), values(200), "before it has a height");
});

test("axes with separate limits get round numbers next to them, which stay", () => {
  assert.ok(scaleLabels({ low: -1.25, high: 1.25 }, null, CLEARANCE).every(({ round }) => !round));
});

test("a pop-up stands right of its bar, else left of it, and always in the box", () => {
  assert.equal(placeBeside(100, 130, 150, 700), 140);
  assert.equal(placeBeside(600, 630, 150, 700), 440);
  for (const left of [0, 60, 150, 200, 290]) {
    const x = placeBeside(left, left + 20, 250, 318);
    assert.ok(x >= 0 && x + 250 <= 318, `at ${x}`);
  }
});
