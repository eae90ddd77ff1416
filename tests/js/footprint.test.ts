import assert from "node:assert/strict";
import { test } from "node:test";
import {
  asSeen,
  atLeast,
  type Footprint,
  outlineOf,
  partOf,
  reachOf,
  wayOf,
} from "../../robowidgets/js/laser/footprint.ts";

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

test("the arrow is the way of the foremost point in two seconds", () => {
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

test("a small robot is drawn larger, and one whose scanner is elsewhere stands where the scanner sees it", () => {
  near(atLeast(ROUND, 1).radius ?? 0, 0.5);
  assert.equal(atLeast(ROUND, 0.4), ROUND);
  near(outlineOf(atLeast(BOX, 2 * Math.hypot(1, 0.6)))[0]?.x, 1);
  const turned = { ...ROUND, scanner: [0.1, 0, Math.PI] as [number, number, number] };
  near(asSeen(turned, { x: 0.2, y: 0 }).range, 0.1);
  near(Math.cos(asSeen(turned, { x: 0.2, y: 0 }).angle), -1);
});
