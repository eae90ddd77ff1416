import assert from "node:assert/strict";
import { test } from "node:test";
import { toCode } from "../../robowidgets/js/laser/code.ts";
import {
  DEGREE,
  measure,
  parseRays,
  type Sector,
  type Stretch,
  sectorOf,
  stateOf,
  stretchesOf,
  toExpression,
} from "../../robowidgets/js/laser/sector.ts";
import { sectorOfText } from "../../robowidgets/js/laser/sector_words.ts";
import { circle, near, sweepOf } from "./laser.ts";
import { toNumber, toScan, vectors } from "./vectors.ts";

const between = (start: number, end: number, more: Partial<Sector> = {}): Sector => ({
  start: start * DEGREE,
  end: end * DEGREE,
  ...more,
});
const SECTORS = [
  between(-15, 15),
  between(135, 225),
  between(-180, 180),
  { start: 0.1, end: 0.35 },
  between(170.5, -170.25),
  between(2.5, -2.5),
  { start: 0.35, end: 0.1 },
];

for (const given of vectors.scans) {
  const [held, own] = vectors.sectors[given.name] ?? [[], []];
  test(`sectors have the same measurements as in Python: ${given.name}`, () => {
    const scan = toScan(given);
    assert.equal(held.length, SECTORS.length);
    for (const [i, [stretches, distance, nearest, median, valid]] of held.entries()) {
      const found = stretchesOf(scan, SECTORS[i] as Sector);
      assert.deepEqual(found, stretches);
      const measured = measure(scan, found);
      assert.ok(Object.is(Math.fround(measured.distance), Math.fround(toNumber(distance))), `distance of sector ${i}`);
      assert.equal(measured.nearest, nearest);
      assert.equal(measured.valid, valid);
      assert.ok(Object.is(measured.median, toNumber(median)), `median of sector ${i}`);
    }
  });
  test(`rays have the sector that Python gives them: ${given.name}`, () => {
    for (const [first, last, start, end] of own) assert.deepEqual(sectorOf(toScan(given), first, last), { start, end });
  });
}

test("the page writes the code that Python writes", () => {
  const [first] = vectors.scans;
  assert.ok(first && vectors.codes.length);
  for (const [start, end, offset, given, scan, message, slice] of vectors.codes) {
    const sweep = toScan(first);
    const mount = given ?? undefined;
    assert.equal(toCode({ start, end }, "scan", sweep, offset, mount), scan);
    assert.equal(toCode({ start, end }, "message", sweep, offset, mount), message);
    assert.equal(toCode({ start, end }, "slice", sweep, offset, mount), slice);
  }
});

test("the sector of rays holds these and no others, whatever the scanner", () => {
  const sweeps = [circle(), circle(360, 0), circle(720), sweepOf(270, 1081), sweepOf(180, 20_000), sweepOf(60, 61, 60)];
  for (const forth of sweeps) {
    for (const sweep of [forth, { ...forth, angleIncrement: -forth.angleIncrement }]) {
      for (const [first, last] of [
        [0, 0],
        [3, 3],
        [3, 9],
        [10, sweep.count - 1],
      ] as const) {
        assert.deepEqual(stretchesOf(sweep, sectorOf(sweep, first, last)), [[first, last + 1]]);
      }
    }
  }
  assert.deepEqual(stretchesOf(circle(360, 0), sectorOf(circle(360, 0), 350, 369)), [
    [350, 360],
    [0, 10],
  ]);
  const { start, end } = sectorOf(sweepOf(270, 1081), 500, 600);
  assert.ok(near(start, -10 * DEGREE) && near(end, 15 * DEGREE), "few decimals");
});

test("a state holds until the distance is larger by the hysteresis", () => {
  const sector = between(0, 1, { near: 2, warning: 1, stop: 0.5, hysteresis: 0.1 });
  assert.equal(stateOf(sector, 0.49, "free"), "stop");
  assert.equal(stateOf(sector, 0.55, "stop"), "stop");
  assert.equal(stateOf(sector, 0.55, "free"), "warning");
  assert.equal(stateOf(sector, 1.05, "stop"), "warning");
  assert.equal(stateOf(sector, 1.05, "occupied"), "occupied");
  assert.equal(stateOf(sector, 2.05, "warning"), "occupied");
  assert.equal(stateOf(sector, 2.05, "free"), "free");
  assert.equal(stateOf(sector, Infinity, "stop"), "free");
  assert.equal(stateOf(sector, NaN, "stop"), "unknown");
  assert.equal(stateOf(between(0, 1), 0.1, ""), "");
});

test("text names rays as Python's slices do, and any other text is rejected", () => {
  const rows: [string, Stretch[] | null][] = [
    ["ranges[240:300]", [[240, 300]]],
    [" msg.ranges[ 5 : 7 ] ", [[5, 7]]],
    ["[-10:]", [[350, 360]]],
    [
      "ranges[350:] + ranges[:10]",
      [
        [350, 360],
        [0, 10],
      ],
    ],
    ["ranges[-1]", [[359, 360]]],
    ["ranges[300:999]", [[300, 999]]],
    ["ranges[-400:10]", [[-40, 10]]],
    ["ranges[5:5]", [[5, 5]]],
    ["ranges[400]", [[400, 401]]],
    ["ranges[1:9:2]", null],
    ["ranges[]", null],
    ["range[1:2]", null],
    ["ranges[1:2]; alert(1)", null],
    ["__import__('os')", null],
    ["", null],
  ];
  for (const [text, expected] of rows) assert.deepEqual(parseRays(text, 360), expected, text);
});

test("stretches are written as a program writes them", () => {
  assert.equal(toExpression([[540, 610]], 1040), "ranges[540:610]");
  assert.equal(toExpression([[0, 1040]], 1040), "ranges[0:1040]");
  assert.equal(
    toExpression(
      [
        [350, 360],
        [0, 10],
      ],
      360,
    ),
    "ranges[350:] + ranges[:10]",
  );
  assert.equal(toExpression([], 360), "");
});

test("a text of rays on both sides of the array is a sector on a full circle alone", () => {
  const text = "ranges[350:] + ranges[:10]";
  assert.deepEqual(stretchesOf(circle(360), sectorOfText(circle(360), text) as Sector).flat(), [350, 360, 0, 10]);
  assert.equal(sectorOfText(sweepOf(180, 360), text), "these rays are not one sector");
});

test("rays beyond the array are reported, and so is a slice without rays", () => {
  const scanner = circle(360);
  for (const text of [
    "ranges[300:361]",
    "ranges[360]",
    "ranges[360:]",
    "ranges[-361:]",
    "ranges[350:] + ranges[:400]",
  ]) {
    assert.equal(sectorOfText(scanner, text), "this scan has 360 rays, the last is ranges[359]", text);
  }
  for (const text of ["ranges[5:5]", "ranges[9:2]", "ranges[350:] + ranges[:0]"]) {
    assert.equal(sectorOfText(scanner, text), "no ray is in this slice", text);
  }
  assert.deepEqual(stretchesOf(scanner, sectorOfText(scanner, "ranges[-360:360]") as Sector), [[0, 360]]);
});
