import assert from "node:assert/strict";
import { test } from "node:test";
import {
  asSeen,
  atLeast,
  type Footprint,
  outlineOf,
  partOf,
  reachOf,
  speedAt,
  touchesAt,
  wayOf,
} from "../../robowidgets/js/laser/footprint.ts";
import type { Speeds } from "../../robowidgets/js/shared/frames/speeds.ts";
import type { Touch } from "../../robowidgets/js/shared/frames/touch.ts";

const ROUND: Footprint = { radius: 0.2, polygon: [], bumpers: {}, scanner: [0, 0, 0], speed: "", touch: "" };
const BOX: Footprint = {
  ...ROUND,
  radius: null,
  polygon: [
    [0.5, 0.3],
    [-0.5, 0.3],
    [-0.5, -0.3],
    [0.5, -0.3],
  ],
};
const near = (value: number | undefined, expected: number) =>
  assert.ok(Math.abs((value ?? NaN) - expected) < 1e-6, `expected ${expected}, got ${value}`);

test("the outline of a robot is its circle or its corners, and a bumper follows it", () => {
  near(reachOf(ROUND, 1), 0.2);
  near(reachOf(BOX, 0), 0.5);
  near(reachOf(BOX, Math.PI / 2), 0.3);
  near(reachOf(BOX, Math.atan2(0.3, 0.5)), Math.hypot(0.3, 0.5));
  assert.equal(outlineOf(BOX).length, 4);
  for (const { x } of partOf(BOX, { start: -0.5, end: 0.5 })) near(x, 0.5);
});

test("the arrow is the path of the foremost point in two seconds", () => {
  near(wayOf(ROUND, 0.4, 0, 0).at(-1)?.x, 1);
  near(wayOf(ROUND, -0.4, 0, 0)[0]?.x, -0.2);
  near(wayOf(ROUND, -0.4, 0, 0).at(-1)?.x, -1);
  // Turning on the spot by a quarter, the nose ends on the left.
  near(wayOf(ROUND, 0, 0, Math.PI / 4).at(-1)?.y, 0.2);
  const curve = wayOf(ROUND, 0.5, 0, Math.PI / 4).at(-1);
  assert.ok(Math.abs((curve?.x ?? 0) - (4 * 0.5) / Math.PI) < 0.01, "a circle of radius v / w");
  assert.deepEqual(wayOf(ROUND, 0.001, 0, 0.001), []);
  assert.deepEqual(wayOf(ROUND, NaN, 0, NaN), []);
});

test("a small robot is drawn larger, and one whose scanner is off-centre stands at its place for the scanner", () => {
  near(atLeast(ROUND, 1).radius ?? 0, 0.5);
  assert.equal(atLeast(ROUND, 0.4), ROUND);
  near(outlineOf(atLeast(BOX, 2 * Math.hypot(1, 0.6)))[0]?.x, 1);
  const turned = { ...ROUND, scanner: [0.1, 0, Math.PI] as [number, number, number] };
  near(asSeen(turned, { x: 0.2, y: 0 }).range, 0.1);
  near(Math.cos(asSeen(turned, { x: 0.2, y: 0 }).angle), -1);
});

test("a robot on a scan of another moment has neither a speed nor touches that came later", () => {
  const scan = { sequence: 9, rate: 10, arrived: 100 };
  const speedOf = (arrived: number, rate = 10) =>
    speedAt({ ...scan, rate }, { ...scan, arrived, measured: [0.4] } as Speeds)?.[0];
  const touchOf = (arrived: number, rate = 10) => {
    const sensors = [{ name: "left", state: "touched", touches: 1, seconds: 0 }];
    return touchesAt({ ...scan, rate }, { ...scan, arrived, sensors } as Touch).get("left");
  };
  for (const near of [99.1, 100.9]) assert.deepEqual([speedOf(near), touchOf(near)], [0.4, "touched"]);
  assert.deepEqual([speedOf(80), touchOf(80)], [undefined, "touched"], "a sensor may tell changes alone");
  assert.deepEqual([speedOf(120), touchOf(120)], [undefined, undefined]);
  // The next scan of a slow scanner is not due yet; a player has no rate.
  assert.deepEqual([speedOf(103, 0.5), touchOf(103, 0.5)], [0.4, "touched"]);
  assert.deepEqual([speedOf(900, NaN), touchOf(900, NaN)], [0.4, "touched"]);
  assert.deepEqual([speedAt(null, null), touchesAt(scan, null).size], [null, 0]);
});
