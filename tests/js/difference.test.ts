import assert from "node:assert/strict";
import { test } from "node:test";
import { difference, isSameSweep, largest } from "../../robowidgets/js/laser/difference.ts";
import { largestWords } from "../../robowidgets/js/laser/ghost_layer.ts";
import { near, scanOf } from "./laser.ts";

const SWEEP = { angleMin: -0.2, angleIncrement: 0.1, maxRange: 10 };

function isLike(actual: Float32Array, expected: number[]): void {
  assert.equal(actual.length, expected.length);
  for (const [i, value] of actual.entries()) {
    const wanted = expected[i] as number;
    assert.ok(Object.is(value, wanted) || near(value, wanted, 1e-5), `${i}: ${value}, and not ${wanted}`);
  }
}

test("each ray counts as in Python's scan - other", () => {
  const now = scanOf([2, 1, Infinity, 3, Infinity, NaN, -Infinity, 0], SWEEP);
  const then = scanOf([1.5, 1, 4, Infinity, 20, 1, 1, 1], SWEEP);
  isLike(difference(now, then), [0.5, 0, Infinity, -Infinity, 0, NaN, -1, NaN]);
});

test("other angles are compared by angle", () => {
  const now = scanOf([9, 9, 9, 9, 9], SWEEP);
  isLike(difference(now, scanOf([1, 2, 3], { ...SWEEP, angleMin: -0.1 })), [NaN, 8, 7, 6, NaN]);
  isLike(difference(now, scanOf([5, 4, 3, 2, 1], { ...SWEEP, angleMin: 0.2, angleIncrement: -0.1 })), [8, 7, 6, 5, 4]);
  isLike(difference(now, scanOf([1, 2, 3, 4, 5], { ...SWEEP, angleMin: -0.2 + 2 * Math.PI })), [8, 7, 6, 5, 4]);
  assert.ok(isSameSweep(now, scanOf([1, 1, 1, 1, 1], SWEEP)));
});

test("the text names the largest finite difference", () => {
  const found = Float32Array.from([0.1, -0.32, Infinity, NaN, 0.2]);
  assert.equal(largest(found), 1);
  assert.equal(largestWords(found), "\u22120.32 m at [1]");
  assert.equal(largestWords(Float32Array.from([0, 0.5])), "+0.50 m at [1]");
  assert.equal(largest(Float32Array.from([0, NaN, -Infinity])), -1);
  assert.equal(largestWords(Float32Array.from([0])), "");
});
