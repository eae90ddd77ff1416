import assert from "node:assert/strict";
import { test } from "node:test";
import { pointAt, toRuns } from "../../robowidgets/js/shared/time_lines.ts";
import { toFacts } from "../../robowidgets/js/speed/facts.ts";
import { spansOver, toTimeLines } from "../../robowidgets/js/speed/time_lines.ts";

const points = (...pairs: [number, number][]) => pairs.map(([at, value]) => ({ at, value }));
const speeds = (x: number, yaw = 0) => [x, 0, 0, 0, 0, yaw];

const groups = toFacts(null, {
  limits: { linear: [-0.5, 0.5], angular: null, axes: {} },
  planar: true,
  marksPeaks: false,
  fastest: { linear: 0, angular: 1, steering: 0 },
});

test("the last seconds of each axis on show become lines, by the time before the last sample", () => {
  const samples = [0, 1000, 2000, 3000].map((at) => ({
    at,
    frame: { measured: speeds(at / 1000), commanded: at < 3000 ? null : speeds(0.2) },
  }));
  const lines = toTimeLines(samples, groups, 2);
  assert.deepEqual(
    lines.map(({ name }) => name),
    ["linear.x", "linear.y", "angular.z"],
  );
  assert.deepEqual(lines[0]?.measured, points([-2000, 1], [-1000, 2], [0, 3]));
  assert.deepEqual(toRuns(lines[0]?.commanded ?? []), [points([0, 0.2])], "before it nothing was commanded");
  assert.deepEqual(lines[0]?.over, [[-2000, 0]]);
  assert.deepEqual(lines[2]?.over, [], "without limits nothing is past them");
  assert.deepEqual(toTimeLines([], groups, 2)[0]?.measured, []);
});

test("a sample with an unknown time is left out", () => {
  const samples = [NaN, 0, 500].map((at) => ({ at, frame: { measured: speeds(0.1), commanded: null } }));
  assert.equal(toTimeLines(samples, groups, 10)[0]?.measured.length, 2);
});

test("a span past a limit ends with the first sample within it, and with a silence", () => {
  const line = points([0, 0], [100, 0.6], [200, 0.7], [300, 0.5], [400, -0.6], [3000, 0], [3100, 0.9]);
  assert.deepEqual(spansOver(line, [-0.5, 0.5]), [
    [100, 300],
    [400, 400],
    [3100, 3100],
  ]);
  assert.deepEqual(spansOver(line, null), []);
});

test("a line is broken by a silence and by a sample without a value", () => {
  const runs = toRuns(points([0, 1], [100, 2], [200, NaN], [300, 3], [2000, 4]));
  assert.deepEqual(
    runs.map((run) => run.map(({ value }) => value)),
    [[1, 2], [3], [4]],
  );
});

test("the line of a slow source is broken by a silence, not by its steps", () => {
  const runs = toRuns(points([0, 1], [2000, 2], [4100, 3], [6000, 4], [16_001, 5]));
  assert.deepEqual(
    runs.map((run) => run.length),
    [4, 1],
  );
});

test("a speed holds until the next sample", () => {
  const line = points([-300, 1], [-200, 2], [0, 3]);
  assert.equal(pointAt(line, -150)?.value, 2);
  assert.equal(pointAt(line, 0)?.value, 3);
  assert.equal(pointAt(line, -900)?.value, 1);
  assert.equal(pointAt([], 0), null);
});
