import assert from "node:assert/strict";
import { test } from "node:test";
import {
  angleOf,
  classify,
  decodeScan,
  indexAt,
  isFullCircle,
  NO_MEASUREMENT,
  NOTHING_IN_RANGE,
  OUTSIDE_LIMITS,
  READING,
  TOO_CLOSE,
} from "../../robowidgets/js/shared/frames/scan.ts";
import { DEGREE, near, scanOf } from "./laser.ts";
import { toScan, vectors } from "./vectors.ts";

for (const given of vectors.scans) {
  test(`as in Python: ${given.name}`, () => {
    const scan = toScan(given);
    if (given.validity) assert.deepEqual(scan.kinds, given.validity);
    assert.deepEqual(scan.counts, given.counts);
    assert.equal(scan.nearest, given.nearest ?? -1);
    assert.equal(isFullCircle(scan), given.full_circle);
    for (const [index, degrees] of Object.entries(given.angles ?? {})) {
      const off = angleOf(scan, Number(index)) / DEGREE - degrees;
      assert.ok(near(((off + 540) % 360) - 180, 0, 1e-3), `ray ${index} is off by ${off} degrees`);
    }
    for (const [degrees, index] of given.at ?? []) {
      assert.equal(indexAt(scan, degrees * DEGREE), index ?? -1, `at ${degrees} degrees`);
    }
  });
}

test("a frame without intensities has none", () => {
  const bytes = new DataView(new ArrayBuffer(32 + 40 + 8));
  bytes.setFloat64(32 + 32, 2, true);
  const scan = decodeScan(bytes);
  assert.equal(scan.ranges.length, 2);
  assert.equal(scan.intensities.length, 0);
});

test("the five classes are checked in REP-117's order", () => {
  const cases: [number, number, number, number][] = [
    [1, 0.1, 5, READING],
    [0.1, 0.1, 5, READING],
    [5, 0.1, 5, READING],
    [-Infinity, 0.1, 5, TOO_CLOSE],
    [Infinity, 0.1, 5, NOTHING_IN_RANGE],
    [Number.NaN, 0.1, 5, NO_MEASUREMENT],
    [0, 0.1, 5, OUTSIDE_LIMITS],
    [5.0001, 0.1, 5, OUTSIDE_LIMITS],
    [-1, 0.1, 5, OUTSIDE_LIMITS],
    [0, 0, 5, READING],
  ];
  for (const [range, low, high, kind] of cases) assert.equal(classify(range, low, high), kind, `${range}`);
});

test("whole turns do not change the ray of an angle", () => {
  const scan = scanOf([1, 2, 3]);
  for (const turns of [-2, -1, 0, 1, 3]) {
    assert.equal(indexAt(scan, 0.5 + turns * 2 * Math.PI), 2);
    assert.equal(indexAt({ ...scan, angleMin: 0.5, angleIncrement: -0.5 }, 0.5 + turns * 2 * Math.PI), 0);
  }
});

test("a lone ray without a step is at every angle, so that a pointer can reach it", () => {
  const one = scanOf([10.47], { angleMin: 0.3, angleIncrement: 0 });
  for (const angle of [0.3, 0, 3, -3]) assert.equal(indexAt(one, angle), 0);
});
