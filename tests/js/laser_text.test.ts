import assert from "node:assert/strict";
import { test } from "node:test";
import { CLASSES, describeRay, meaningOf, sideOf, whyEmpty } from "../../robowidgets/js/laser/text.ts";
import { DEGREE, scanOf } from "./laser.ts";

const MINUS = "\u2212";
const scan = scanOf([2, -Infinity, Infinity, Number.NaN, 0.05, 61], {
  angleMin: 0,
  angleIncrement: Math.PI / 2,
  maxRange: 60,
});

test("each value means something", () => {
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

test("a reading is told with distance, angle, x and y", () => {
  assert.deepEqual(describeRay(scanOf([2], { angleMin: 30 * DEGREE, angleIncrement: 0 }), 0), {
    expression: "ranges[0]",
    distance: "2.00 m",
    angle: "30.0°",
    details: "x\u00A01.73  y\u00A01.00",
    side: "left",
  });
  assert.equal(describeRay(scanOf([2], { angleMin: -90 * DEGREE }), 0).details, `x\u00A00.00  y\u00A0${MINUS}2.00`);
});

test("a reading in a picture of millimetres has their decimals", () => {
  const near = { ...scanOf([0.003], { angleMin: 0 }), minRange: 0, kinds: [0] };
  const { distance, details } = describeRay(near as never, 0, 0.004);
  assert.deepEqual([distance, details], ["0.0030 m", "x\u00A00.0030  y\u00A00.0000"]);
});

test("a ray without a reading is told with what its value means", () => {
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

test("an intensity is told where there is one", () => {
  const bright = { ...scan, intensities: Float32Array.of(47, 0.5, 3, Number.NaN, 1, 2) };
  const details = [0, 1, 3].map((index) => describeRay(bright, index).details.split("\n")[1]);
  assert.deepEqual(details, ["intensity 47", "intensity 0.50", "intensity NaN"]);
});

test("a pinned ray that a shorter scan no longer has is told so", () => {
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

test("a picture without readings says why", () => {
  const all = (value: number, count = 360) =>
    whyEmpty(
      scanOf(
        Array.from({ length: count }, () => value),
        { minRange: Math.fround(0.12), maxRange: 3.5 },
      ),
    );
  assert.equal(whyEmpty(scanOf([])), "this scan is empty: it has no rays");
  assert.equal(whyEmpty(scanOf([]), ["no scan up to this time of the recording"]), "", "its note does");
  assert.equal(whyEmpty(scan), "");
  assert.equal(all(Infinity), "no readings: all 360 rays say +inf: nothing within 3.5 m");
  assert.equal(all(-Infinity), `no readings: all 360 rays say ${MINUS}inf: closer than 0.12 m`);
  assert.equal(all(Number.NaN), "no readings: all 360 rays say NaN: no measurement");
  assert.equal(all(0), "no readings: all 360 rays say 0.000 m, outside the limits 0.12 m to 3.5 m");
  assert.equal(all(Infinity, 1), "no readings: the one ray says +inf: nothing within 3.5 m");
  assert.equal(all(9, 1), "no readings: the one ray says 9.000 m, outside the limits 0.12 m to 3.5 m");
  assert.equal(whyEmpty(scanOf([0, 99, 0.05])), "no readings: all 3 rays are outside the limits 0.1 m to 30 m");
  assert.equal(
    whyEmpty(scanOf([0, 99, Infinity, Number.NaN, -Infinity])),
    "no readings: 2 outside, 1 nothing, 1 none, 1 too close",
  );
});
