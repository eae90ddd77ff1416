import assert from "node:assert/strict";
import { test } from "node:test";
import { freeOutlines } from "../../robowidgets/js/laser/free_layer.ts";
import { DEGREE, scanOf } from "./laser.ts";

const projection = { centerX: 0, centerY: 0, radius: 100, viewRange: 5, forward: Math.PI / 2 };
/** The range of each outline, in metres. */
const reaches = (ranges: number[], maxRange = 4) => {
  const scan = scanOf(ranges, { angleMin: -20 * DEGREE, angleIncrement: 10 * DEGREE, maxRange });
  return freeOutlines({ scan, projection }).map((outline) =>
    outline.map(({ x, y }) => Math.round(Math.hypot(x, y) / 2) / 10),
  );
};

test("free space ends at each reading, and at the rim if nothing is in range", () => {
  assert.deepEqual(reaches([2, Infinity, 3]), [[2, 2, 4, 4, 3, 3]]);
  assert.deepEqual(reaches([2, Infinity], 30), [[2, 2, 5, 5]], "the view ends before the limit");
});

test("a ray that is not measured, too close or outside the limits shows no free space", () => {
  assert.deepEqual(reaches([2, Number.NaN, 3, Number.NEGATIVE_INFINITY, 0.01]), [
    [2, 2],
    [3, 3],
  ]);
  assert.deepEqual(reaches([Number.NaN]), []);
  assert.deepEqual(freeOutlines({ scan: null, projection }), []);
});

test("each ray stands for half of the angle to its neighbours", () => {
  const scan = scanOf([2, 2], { angleMin: 0, angleIncrement: 10 * DEGREE, maxRange: 4 });
  const [outline = []] = freeOutlines({ scan, projection });
  const degrees = outline.map(({ x, y }) => Math.round(Math.atan2(-x, -y) / DEGREE));
  assert.deepEqual(degrees, [-5, 5, 5, 15]);
});
