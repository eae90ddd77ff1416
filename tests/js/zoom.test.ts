import assert from "node:assert/strict";
import { test } from "node:test";
import { decideRange, fitRange, reach, resolveRange } from "../../robowidgets/js/laser/zoom.ts";
import { roundUp, stepRange } from "../../robowidgets/js/shared/zoom.ts";
import { near, randoms, scanOf } from "./laser.ts";

/** A scan whose readings all lie at one distance, but for the farthest few. */
const room = (metres: number, outliers: number[] = []) =>
  scanOf([...Array.from({ length: 1000 - outliers.length }, () => metres), ...outliers], { maxRange: 60 });

test("metres are rounded up to round numbers", () => {
  const cases: [number, number][] = [
    [0.051, 0.06],
    [0.1, 0.1],
    [0.9, 1],
    [1, 1],
    [1.01, 1.5],
    [3.2, 4],
    [6.1, 8],
    [9, 10],
    [10, 10],
    [11, 15],
    [59, 60],
    [60, 60],
    [81, 100],
  ];
  for (const [metres, round] of cases) assert.equal(roundUp(metres), round, `${metres}`);
});

test("rounding up never rounds down, and is round already", () => {
  for (let metres = 0.02; metres < 200; metres *= 1.013) {
    const round = roundUp(metres);
    assert.ok(round >= metres * (1 - 1e-9) && round < metres * 1.6, `${metres} -> ${round}`);
    assert.equal(roundUp(round), round);
  }
});

test("each step in is a step nearer in round numbers, down to 5 cm", () => {
  let metres = 60;
  const seen = [metres];
  while (seen.length < 60 && metres > 0.05) {
    metres = stepRange(metres, -1, 60);
    seen.push(metres);
  }
  assert.deepEqual(seen.slice(0, 12), [60, 50, 40, 30, 25, 20, 15, 10, 8, 6, 5, 4]);
  assert.equal(seen.at(-1), 0.05);
  for (const [i, one] of seen.slice(1).entries()) assert.ok(one < (seen[i] as number));
  assert.equal(stepRange(0.05, -1, 60), 0.05);
});

test("a step out undoes a step in", () => {
  for (const maxRange of [60, 30, 5.6, 3.5, 12.3]) {
    let metres = maxRange;
    for (let i = 0; i < 20 && metres > 0.06; i++) {
      const closer = stepRange(metres, -1, maxRange);
      assert.ok(closer < metres);
      assert.equal(stepRange(closer, 1, maxRange), metres, `${metres} -> ${closer}`);
      metres = closer;
    }
  }
});

test("steps out end at the range of the sensor", () => {
  assert.equal(stepRange(5, 1, 5.6), 5.6);
  assert.equal(stepRange(5.6, 1, 5.6), 5.6);
  assert.equal(stepRange(60, 1, 60), 60);
  assert.equal(stepRange(20, 1, 3.5), 20, "of a program that shows more, nothing is taken away");
});

test("any metres that a program set lead back to round numbers", () => {
  assert.equal(stepRange(4.37, -1, 60), 4);
  assert.equal(stepRange(4.37, 1, 60), 5);
});

test("the reach leaves out the farthest 2 % of the readings, and rays without a reading", () => {
  assert.ok(near(reach(room(4)), 4));
  assert.ok(
    near(
      reach(
        room(
          4,
          Array.from({ length: 20 }, () => 55),
        ),
      ),
      4,
    ),
  );
  assert.ok(
    near(
      reach(
        room(
          4,
          Array.from({ length: 21 }, () => 55),
        ),
      ),
      55,
    ),
  );
  assert.ok(near(reach(scanOf([1, 2, Infinity, Number.NaN, -Infinity, 0, 99])), 2));
  assert.equal(reach(scanOf([Infinity, Number.NaN])), 0);
  assert.equal(reach(scanOf([])), 0);
});

test("readings are ordered as numbers", () => {
  assert.ok(near(reach(scanOf([9, 10, 2], { maxRange: 60 })), 10));
});

test("a 60 m scanner in a 4 m room shows the room", () => {
  assert.equal(fitRange(0, room(3.9)), 5);
  assert.equal(fitRange(0, room(3.9, [55, 58])), 5);
});

test("a fit never exceeds the range of the sensor", () => {
  assert.equal(fitRange(0, scanOf([5.5], { maxRange: 5.6 })), 5.6);
  assert.equal(fitRange(5.6, scanOf([5.6], { maxRange: 5.6 })), 5.6);
});

test("noise changes a fit at most once, wherever it lies", () => {
  const random = randoms(3);
  for (let metres = 0.5; metres < 55; metres *= 1.01) {
    let range = 0;
    let changes = -1;
    for (let i = 0; i < 60; i++) {
      const next = fitRange(range, scanOf([metres * (0.95 + 0.1 * random())], { maxRange: 60 }));
      if (next !== range) changes++;
      range = next;
    }
    assert.ok(changes <= 1, `${changes} changes at ${metres} m`);
  }
});

test("a fit grows at once, and shrinks only when far less is needed", () => {
  const large = fitRange(0, room(9));
  assert.equal(large, 10);
  assert.equal(fitRange(large, room(6)), 10);
  assert.equal(fitRange(large, room(5)), 10);
  assert.equal(fitRange(large, room(4)), 5);
  assert.equal(fitRange(5, room(20)), 25);
});

test("a scanner without a limit shows the range of its readings, and 10 m without readings", () => {
  const maxRange = 3.4028234663852886e38;
  const reading = scanOf([4, 80, 1e30], { maxRange });
  assert.equal(resolveRange("sensor", scanOf([4, 4], { maxRange }), 0), 5);
  assert.equal(resolveRange("sensor", scanOf([4, 3], { maxRange }), 5), 5);
  assert.equal(resolveRange("sensor", scanOf([Infinity], { maxRange }), 0), 10);
  assert.equal(resolveRange("sensor", reading, 0), 100_000);
  assert.equal(resolveRange(30, reading, 0), 30);
  assert.equal(stepRange(100_000, 1, maxRange), 100_000);
  assert.equal(resolveRange("sensor", scanOf([4], { maxRange: 2000 }), 0), 2000);
});

test("a scan without readings leaves the fit as it was", () => {
  const empty = scanOf([Infinity, Number.NaN], { maxRange: 12 });
  assert.equal(fitRange(4, empty), 4);
  assert.equal(fitRange(0, empty), 12);
});

test("the setting is resolved to metres", () => {
  assert.equal(resolveRange(7.5, null, 0), 7.5);
  assert.equal(resolveRange(7.5, room(2), 0), 7.5);
  assert.equal(resolveRange("sensor", room(2), 0), 60);
  assert.equal(resolveRange("data", room(2), 0), 2.5);
  assert.equal(resolveRange("data", room(2.6), 4), 4);
  assert.equal(resolveRange("data", null, 4), 4);
  assert.equal(resolveRange("sensor", null, 0), 10);
});

test("the first scan with a reading decides whether the picture fits the readings: if they fill less than a third", () => {
  assert.equal(decideRange(scanOf([Number.POSITIVE_INFINITY, 0], { maxRange: 60 })), null);
  assert.equal(decideRange(room(19)), "data");
  assert.equal(decideRange(room(19, [50])), "data");
  assert.equal(decideRange(room(21)), "sensor");
});
