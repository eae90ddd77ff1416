import assert from "node:assert/strict";
import { test } from "node:test";
import { explain } from "../../robowidgets/js/later/glossary.ts";

/** The first words of the sentences on a text. */
const subjects = (text: string) => explain(text).map((sentence) => sentence.split(/ is | turns |:| \(/)[0]);

test("words of ROS have one sentence each", () => {
  for (const text of ["nearest 1.00 m at [105]", "[3] sonar_left"]) {
    assert.deepEqual(subjects(text), ["A number in brackets, such as [225],"]);
  }
  assert.deepEqual(subjects("frame odom"), ["odom"]);
  assert.deepEqual(subjects("/odom"), ["Odometry"]);
  assert.deepEqual(subjects("yaw"), ["yaw"]);
  assert.deepEqual(subjects("rad/s"), ["rad"]);
  assert.deepEqual(subjects("orientation"), ["A quaternion"]);
});

test("marks of REP 117 differ by their sign", () => {
  assert.deepEqual(subjects("+inf: nothing in range"), ["+inf"]);
  assert.deepEqual(subjects("inf"), ["+inf"]);
  assert.deepEqual(subjects("\u2212inf: too close"), ["\u2212inf"]);
  assert.deepEqual(subjects("-inf"), ["\u2212inf"]);
  assert.deepEqual(subjects("NaN: no measurement"), ["NaN"]);
});

test("other words have no sentence", () => {
  for (const text of ["", "radius", "information", "rolling", "/odometer", "base_link_2", "0.40", "reading"]) {
    assert.deepEqual(explain(text), [], text);
  }
});
