import assert from "node:assert/strict";
import { test } from "node:test";
import { pick } from "../../robowidgets/js/laser/pick.ts";
import { angleOf } from "../../robowidgets/js/shared/frames/scan.ts";
import { toPixel } from "../../robowidgets/js/shared/projection.ts";
import { BOXES, circle, DEGREE, layOut, SWEEPS, scanOf, sweepOf } from "./laser.ts";

const box = BOXES[2];

test("the pointer on a reading names it, for every ray of every sweep", () => {
  for (const [name, sweep] of Object.entries(SWEEPS)) {
    const scan = scanOf(
      Array.from({ length: sweep.count }, (_, i) => 4 + 3 * Math.sin(i)),
      sweep,
    );
    const { projection } = layOut(sweep, box);
    for (let i = 0; i < sweep.count; i++) {
      const index = pick(projection, scan, toPixel(projection, scan.ranges[i] as number, angleOf(scan, i)));
      // Two rays may have the same direction if a circle repeats its end ray.
      const same = Math.abs(Math.sin((angleOf(scan, index) - angleOf(scan, i)) / 2)) < 1e-9;
      assert.ok(index === i || (same && scan.ranges[index] === scan.ranges[i]), `${name}: ray ${i}, not ${index}`);
    }
  }
});

test("a reading close to the pointer comes before the ray of its direction", () => {
  const scan = scanOf(
    Array.from({ length: 181 }, (_, i) => (i === 90 ? 5 : Infinity)),
    sweepOf(180, 181),
  );
  const { projection } = layOut(scan, box);
  const { x, y } = toPixel(projection, 5, 0);
  assert.equal(pick(projection, scan, { x: x + 7, y: y - 4 }), 90);
  assert.notEqual(pick(projection, scan, { x: x + 12, y }), 90);
});

test("of two readings the nearer to the pointer is named", () => {
  const scan = scanOf([5, 5, 5], { angleMin: -DEGREE, angleIncrement: DEGREE });
  const { projection } = layOut(scan, box);
  for (const i of [0, 1, 2]) assert.equal(pick(projection, scan, toPixel(projection, 4.98, angleOf(scan, i))), i);
});

test("a ray without a reading is named by its direction, along all its length", () => {
  for (const value of [Infinity, -Infinity, Number.NaN, 0, 99]) {
    const scan = scanOf(
      Array.from({ length: 360 }, () => value),
      circle(),
    );
    const { projection } = layOut(scan, box);
    for (const range of [0.5, 3, 10]) {
      assert.equal(pick(projection, scan, toPixel(projection, range, 90 * DEGREE)), 270);
      assert.equal(pick(projection, scan, toPixel(projection, range, -90 * DEGREE)), 90);
    }
  }
});

test("marks just beyond the rim can be pointed at, labels cannot", () => {
  const scan = scanOf(
    Array.from({ length: 360 }, () => Infinity),
    circle(),
  );
  const { projection } = layOut(scan, box);
  const metresOf = (pixels: number) => (pixels / projection.radius) * projection.viewRange;
  assert.equal(pick(projection, scan, toPixel(projection, 10 + metresOf(8), 0)), 180);
  assert.equal(pick(projection, scan, toPixel(projection, 10 + metresOf(20), 0)), -1);
});

test("nothing is named on the robot, outside the sweep, or in an empty scan", () => {
  const scan = scanOf(
    Array.from({ length: 181 }, () => 5),
    sweepOf(180, 181),
  );
  const { projection } = layOut(scan, box);
  assert.equal(pick(projection, scan, { x: projection.centerX + 2, y: projection.centerY - 2 }), -1);
  assert.equal(pick(projection, scan, toPixel(projection, 5, 180 * DEGREE)), -1);
  assert.equal(pick(projection, scanOf([]), toPixel(projection, 5, 0)), -1);
});
