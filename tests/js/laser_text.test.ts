import assert from "node:assert/strict";
import { test } from "node:test";
import { describeRay, sourceOf } from "../../robowidgets/js/laser/text.ts";
import { sideOf } from "../../robowidgets/js/shared/format.ts";
import { CLASSES, meaningOf } from "../../robowidgets/js/shared/frames/classes.ts";
import { DEGREE, scanOf } from "./laser.ts";

const MINUS = "\u2212";
const scan = scanOf([2, -Infinity, Infinity, Number.NaN, 0.05, 61], {
  angleMin: 0,
  angleIncrement: Math.PI / 2,
  maxRange: 60,
});

test("each class has a meaning", () => {
  assert.deepEqual(
    scan.kinds.map((_, index) => meaningOf(scan, index)),
    [
      "",
      `${MINUS}inf: closer than 0.1 m`,
      "+inf: nothing within 60 m",
      "NaN: no measurement",
      "outside the limits 0.1 m to 60 m",
      "outside the limits 0.1 m to 60 m",
    ],
  );
});

test("a scanner without a limit sees nothing in range, and nothing beyond it", () => {
  const without = scanOf([Infinity, 0.05], { maxRange: 3.4028234663852886e38 });
  assert.equal(meaningOf(without, 0), "+inf: nothing in range");
  assert.equal(meaningOf(without, 1), "outside the limits 0.1 m to \u221e");
});

test("the classes are numbered and named as in Python", () => {
  const named = [...CLASSES].sort((a, b) => a.kind - b.kind).map(({ name }) => name);
  assert.deepEqual(named, ["reading", "too_close", "nothing_in_range", "no_measurement", "outside_limits"]);
});

test("the pop-up of a reading has distance, angle, x and y", () => {
  assert.deepEqual(describeRay(scanOf([2], { angleMin: 30 * DEGREE, angleIncrement: 0 }), 0), {
    expression: "ranges[0]",
    distance: "2.00 m",
    angle: "30.0°",
    details: "x\u00A01.73  y\u00A01.00",
    side: "left",
  });
  assert.equal(describeRay(scanOf([2], { angleMin: -90 * DEGREE }), 0).details, `x\u00A00.00  y\u00A0${MINUS}2.00`);
});

test("x and y are in the frame of the angle on show", () => {
  const own = (angle: number) => 90 * DEGREE - angle;
  const { angle, details, side } = describeRay(scanOf([2], { angleMin: 120 * DEGREE }), 0, 1, "deg", "", own);
  assert.deepEqual([angle, details, side], [`${MINUS}30.0°`, `x\u00A01.73  y\u00A0${MINUS}1.00`, "left"]);
});

test("a reading in a picture of millimetres has their decimals", () => {
  const near = { ...scanOf([0.003], { angleMin: 0 }), minRange: 0, kinds: [0] };
  const { distance, details } = describeRay(near as never, 0, 0.004);
  assert.deepEqual([distance, details], ["0.0030 m", "x\u00A00.0030  y\u00A00.0000"]);
});

test("a reading from 1 km on is shown in kilometres, also its place", () => {
  const far = { ...scanOf([3000], { angleMin: 30 * DEGREE }), maxRange: 5000, kinds: [0] };
  const { distance, details } = describeRay(far as never, 0, 5000);
  assert.deepEqual([distance, details], ["3.000 km", "x\u00A02.598 km  y\u00A01.500 km"]);
});

test("the pop-up of a ray without a reading has the meaning of its value", () => {
  const told = [1, 2, 3, 4].map((index) => describeRay(scan, index));
  assert.deepEqual(
    told.map(({ distance }) => distance),
    [`${MINUS}inf`, "+inf", "NaN", "0.050 m"],
  );
  assert.deepEqual(
    told.map(({ details }) => details),
    [1, 2, 3, 4].map((index) => meaningOf(scan, index)),
  );
  assert.deepEqual(
    told.map(({ side }) => side),
    ["left", "behind", "right", "ahead"],
  );
});

test("the pop-up has an intensity if the scan has one", () => {
  const bright = { ...scan, intensities: Float32Array.of(47, 0.5, 3, Number.NaN, 1, 2) };
  const details = [0, 1, 3].map((index) => describeRay(bright, index).details.split("\n")[1]);
  assert.deepEqual(details, ["intensity 47", "intensity 0.50", "intensity NaN"]);
});

test("the pop-up of a pinned ray that a shorter scan lacks reports it", () => {
  assert.deepEqual(describeRay(scan, 700), {
    expression: "ranges[700]",
    distance: "\u2014",
    angle: "",
    details: "this scan has 6 rays",
    side: "",
  });
  assert.equal(describeRay(scanOf([1]), 3).details, "this scan has 1 ray");
});

test("sides are the robot's", () => {
  const sides = [0, 0.01, 1, 89, 179, 180, -180, -1, -90, 270, 360, 450].map((degrees) => sideOf(degrees * DEGREE));
  assert.deepEqual(sides, [
    "ahead",
    "ahead",
    "left",
    "left",
    "left",
    "behind",
    "behind",
    "right",
    "right",
    "right",
    "ahead",
    "left",
  ]);
});

test("the range of a scan that was made of other data has its place in these data", () => {
  const made = { ...scan, sources: Float32Array.of(2, Number.NaN, 0) };
  const about = { made_of: ["last echo", "ranges[{ray}].echoes[{number}]"] } as const;
  assert.deepEqual(
    [0, 1, 2, 9].map((index) => sourceOf(made, index, { made_of: [...about.made_of] })),
    ["ranges[0].echoes[2]", "", "ranges[2].echoes[0]", ""],
  );
  assert.equal(sourceOf(scan, 0, {}), "");
});
