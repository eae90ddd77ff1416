import assert from "node:assert/strict";
import { test } from "node:test";
import { pick } from "../../robowidgets/js/laser/pick.ts";
import {
  fromStrip,
  indexTicks,
  metreTicks,
  placeOf,
  plotBox,
  toPicture,
  toX,
  toY,
} from "../../robowidgets/js/laser/strip_axis.ts";
import { BOXES, DEGREE, layOut, SWEEPS, scanOf } from "./laser.ts";

const axes = (width: number, count: number, viewRange = 3.5) => ({
  box: plotBox(width, width < 460 ? 90 : 150),
  count,
  viewRange,
});

test("a ray and a distance are found at their drawn places", () => {
  for (const count of [1, 2, 360, 1040, 20_000]) {
    const strip = axes(700, count);
    for (const index of [0, Math.floor(count / 2), count - 1]) {
      const found = fromStrip(strip, toX(strip, index), toY(strip, 1.25));
      assert.equal(found.index, index);
      assert.ok(Math.abs(found.metres - 1.25) < 1e-9);
    }
  }
  const strip = axes(700, 100);
  assert.deepEqual(fromStrip(strip, -50, -50), { index: 0, metres: 3.5 });
  assert.deepEqual(fromStrip(strip, 5000, 5000), { index: 99, metres: 0 });
});

test("a point of the index view names the ray at its index, whatever lies close to it in the picture", () => {
  for (const [name, sweep] of Object.entries(SWEEPS)) {
    // Readings near the scanner cover each other in the picture of a far view.
    const scan = scanOf(
      Array.from({ length: sweep.count }, (_, i) => 1 + (i % 7) / 3),
      sweep,
    );
    const { projection } = layOut(sweep, BOXES[2], 30);
    const strip = axes(700, sweep.count, projection.viewRange);
    for (let i = 0; i < sweep.count; i++) {
      for (const metres of [0, scan.ranges[i] as number, 2.5, 29]) {
        const place = toPicture(strip, scan, projection, { x: toX(strip, i), y: toY(strip, metres) });
        assert.equal(pick(projection, scan, place), i, `${name}: ray ${i} at ${metres} m`);
      }
    }
  }
});

test("indices on the axis are round, begin with [0], end with the last, and keep apart", () => {
  for (const width of [280, 400, 700, 1200]) {
    for (const count of [1, 2, 3, 7, 90, 360, 541, 1040, 1151, 20_000]) {
      const strip = axes(width, count);
      const found = indexTicks(strip);
      assert.equal(found[0], 0);
      if (count > 1 && strip.box.width > 44) assert.equal(found.at(-1), count - 1, `${count} rays at ${width}`);
      const places = found.map((index) => toX(strip, index));
      for (const [i, x] of places.entries()) {
        const before = places[i - 1];
        if (before !== undefined && count > 12) assert.ok(x - before >= 43, `${count} rays at ${width}: ${found}`);
      }
    }
  }
  assert.deepEqual(indexTicks(axes(700, 1151)), [0, 200, 400, 600, 800, 1000, 1150]);
  assert.deepEqual(indexTicks(axes(700, 0)), []);
});

test("metres on the axis are round and above 0", () => {
  assert.deepEqual(metreTicks(axes(700, 360)), [1, 2, 3]);
  for (const range of [0.2, 3.5, 10, 30, 100_000]) {
    const found = metreTicks(axes(400, 360, range));
    assert.ok(found.length >= 1 && found.length <= 4, `${range} m: ${found}`);
  }
});

test("the ends of the array are named by their directions", () => {
  const names = [-135, -90, 0, 90, 135, 180, -180, 359, 405].map((degrees) => placeOf(degrees * DEGREE));
  assert.deepEqual(names, ["right rear", "right", "front", "left", "left rear", "rear", "rear", "front", "left front"]);
});
