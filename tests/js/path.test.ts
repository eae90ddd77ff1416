import assert from "node:assert/strict";
import { test } from "node:test";
import { deflateSync } from "node:zlib";
import { Ground } from "../../robowidgets/js/path/ground.ts";
import type { LayerState } from "../../robowidgets/js/path/layers.ts";
import { boundsOf, multiples, nearestOn, type Point, splitAt, toPoints } from "../../robowidgets/js/path/path.ts";
import { describePoint } from "../../robowidgets/js/path/text.ts";

function point(time: number, x: number, y: number, yaw = 0, way = x): Point {
  return { time, x, y, yaw, way };
}

const LINE = [point(0, 0, 0), point(1, 1, 0), point(3, 2, 0)];

test("the bytes of a path are its points, also at an odd offset of a buffer", () => {
  const buffer = new ArrayBuffer(3 + 80);
  const view = new DataView(buffer, 3);
  for (const [i, value] of [0, 1, 2, 0.5, 0, 1.5, 4, 5, 0.6, 7].entries()) view.setFloat64(8 * i, value, true);
  assert.deepEqual(toPoints(view), [point(0, 1, 2, 0.5, 0), point(1.5, 4, 5, 0.6, 7)]);
  assert.deepEqual(toPoints(new DataView(new ArrayBuffer(0))), []);
});

test("the path up to a moment ends at the pose of that moment, and the rest begins there", () => {
  const now = { time: 2, x: 1.5, y: 0, yaw: 0 };
  const here = { ...now, way: 1.5 };
  assert.deepEqual(splitAt(LINE, now), { before: [...LINE.slice(0, 2), here], after: [here, ...LINE.slice(2)] });
  assert.deepEqual(splitAt([], now), { before: [{ ...now, way: 0 }], after: [{ ...now, way: 0 }] });
});

test("a jump of the robot is a gap in the line, for a pose on show and for the nearest place", () => {
  const bytes = new DataView(new ArrayBuffer(4 * 40));
  const told = [
    [0, 0, 0, 0, 0],
    [1, 1, 0, 0, 1],
    [2, 9, 0, 0, 1],
    [3, 10, 0, 0, 2],
  ];
  for (const [i, value] of told.flat().entries()) bytes.setFloat64(8 * i, value, true);
  const points = toPoints(bytes);
  assert.deepEqual(
    points.map(({ isAfterJump = false }) => isAfterJump),
    [false, false, true, false],
  );
  assert.deepEqual(nearestOn(points, { x: 4, y: 0 }), points[1]);
  const before = splitAt(points, { time: 1.5, x: 1.1, y: 0, yaw: 0 });
  assert.deepEqual([before.before.at(-1)?.isAfterJump, before.after[1]?.isAfterJump], [undefined, true]);
  const after = splitAt(points, { time: 1.9, x: 8.9, y: 0, yaw: 0 });
  assert.deepEqual([after.before.at(-1)?.isAfterJump, after.after[1]?.isAfterJump], [true, false]);
  assert.equal(after.before.at(-1)?.way, 1);
});

test("the distance driven up to a moment is a share of the curve between two points, and grows to the next one", () => {
  const curve = [point(0, 0, 0), point(4, 1, 0, 0, 3)];
  const ways = [0, 0.25, 0.5, 1].map((x) => splitAt(curve, { time: 3, x, y: 0, yaw: 0 }).before.at(-1)?.way);
  assert.deepEqual(ways, [0, 0.75, 1.5, 3]);
  assert.equal(splitAt(curve, { time: 5, x: 1.5, y: 0, yaw: 0 }).before.at(-1)?.way, 3.5);
});

test("before the first pose all of the path is still ahead", () => {
  const nowhere = { time: -1, x: NaN, y: NaN, yaw: NaN };
  assert.deepEqual(splitAt(LINE, nowhere), { before: [], after: LINE });
});

test("the nearest place of a path may lie between two points, with its time and its distance", () => {
  assert.deepEqual(nearestOn(LINE, { x: 1.25, y: 3 }), point(1.5, 1.25, 0));
  assert.deepEqual(nearestOn(LINE, { x: -5, y: 1 }), LINE[0]);
  assert.deepEqual(nearestOn([LINE[1] as Point], { x: 9, y: 9 }), LINE[1]);
  assert.equal(nearestOn([], { x: 0, y: 0 }), null);
});

test("between two headings the shorter way round counts", () => {
  const found = nearestOn([point(0, 0, 0, 3.1), point(1, 2, 0, -3.1)], { x: 1, y: 0 });
  assert.ok(Math.abs((found?.yaw ?? 0) - Math.PI) < 1e-6);
});

test("the floor holds the whole path, fills the picture, and keeps still while the robot moves a little", () => {
  const size = { width: 424, height: 240 };
  const bounds = boundsOf(LINE, size);
  assert.ok(bounds.west < 0 && bounds.east > 2 && bounds.south < 0 && bounds.north > 0);
  const aspect = (bounds.east - bounds.west) / (bounds.north - bounds.south);
  assert.ok(Math.abs(aspect - 400 / 200) < 1e-9);
  assert.deepEqual(boundsOf([...LINE, point(4, 2.01, 0)], size), bounds);
  const alone = boundsOf([point(0, 7, 8)], size);
  assert.ok(alone.east - alone.west >= 2 && alone.west < 7 && alone.east > 7 && alone.north > 8);
  assert.ok(boundsOf([], size).west < 0);
});

test("the pop-up of a place of the path has its time, also from the moment on show", () => {
  const now = { time: 3, x: 2, y: 0, yaw: 0 };
  assert.deepEqual(describePoint(point(1, 1.5, -0.25, Math.PI / 2, 4), now), {
    expression: "1.00 s",
    distance: "x 1.50 m, y \u22120.25 m",
    details: "heading 90.0°\ndriven 4.00 m",
    angle: "",
    side: "2.00 s before",
  });
  assert.equal(describePoint(point(3, 0, 0), now).side, "now");
  assert.equal(describePoint(point(4, 0, 0, NaN), now).details.split("\n")[0], "heading unknown");
});

test("a grid has its lines, and is finite even on a floor as large as only damaged numbers make it", () => {
  assert.deepEqual(multiples(0.5, -0.75, 1), [-0.5, 0, 0.5]);
  const { west, east } = boundsOf(
    [
      { x: 1e79, y: 0 },
      { x: 1e79 + 2e63, y: 1 },
    ],
    { width: 300, height: 200 },
  );
  assert.ok(multiples(1e62, west, east).length < 1e3);
  assert.deepEqual(multiples(1, -Infinity, Infinity), []);
});

/** The bytes of a large grid of layer 0 whose cells are all alike, as Python packs them. */
function packedGrid(version: number, side: number, value: number): DataView {
  const cells = deflateSync(new Uint8Array(side * side).fill(value));
  const bytes = new Uint8Array(56 + cells.length);
  for (const [i, number] of [0, version, side, side, 0.05, 1, cells.length].entries())
    new DataView(bytes.buffer).setFloat64(8 * i, number, true);
  bytes.set(cells, 56);
  return new DataView(bytes.buffer);
}

function grid(version: number, x: number): LayerState {
  const nothing = { number: 0, time: 0, y: 0, yaw: 0, points: [], total: 0, cells: null };
  return { ...nothing, scatter: [NaN, NaN, NaN], version, x };
}

test("a frozen map keeps the place of its large grid while the newest grows, and stepping back finds each", async () => {
  const ground = new Ground();
  const [small, large] = [grid(1, -1), grid(2, -3)];
  const shown = (state: LayerState) => {
    const { cells, corner } = ground.gridOf(state) ?? {};
    return [cells?.rows, cells?.data[0], corner?.x];
  };
  await ground.take(packedGrid(1, 200, 0), [small], () => {});
  assert.deepEqual(shown(small), [200, 0, -1]);
  const taken = ground.take(packedGrid(2, 240, 100), [small], () => {});
  assert.deepEqual(shown(large), [200, 0, -1], "until it is inflated, the one before, at its own corner");
  await taken;
  assert.deepEqual(
    [shown(small), shown(large)],
    [
      [200, 0, -1],
      [240, 100, -3],
    ],
  );
});

test("large grids that are in no sample of the history are dropped, without a substitute", async () => {
  const ground = new Ground();
  for (const version of [1, 2, 3, 4]) await ground.take(packedGrid(version, 200, 0), [grid(2, 0)], () => {});
  assert.deepEqual(
    [1, 2, 3, 4].map((version) => [ground.gridOf(grid(version, 0)) !== null, ground.hasDropped(grid(version, 0))]),
    [[false, true], ...Array(3).fill([true, false])],
  );
  assert.deepEqual([ground.gridOf(grid(5, 0)), ground.hasDropped(grid(5, 0))], [null, false]);
});

test("a history keeps large grids of up to 40 million cells", async () => {
  const ground = new Ground();
  for (const version of [1, 2, 3, 4, 5]) await ground.take(packedGrid(version, 4000, 0), [grid(1, 0)], () => {});
  const kept = [1, 2, 3, 4, 5].filter((version) => ground.gridOf(grid(version, 0)));
  assert.deepEqual(kept, [3, 4, 5]);
});
