import assert from "node:assert/strict";
import { test } from "node:test";
import { toNumberLines } from "../../robowidgets/js/shared/numbers.ts";

test("each name has a line of its numbers of the last ten seconds, by the time before the sample on show", () => {
  const said = [
    { about: { numbers: { r: 9 } }, at: -20_000 },
    { about: { numbers: { r: 1, q: null } }, at: 0 },
    { about: {}, at: 500 },
    { about: { numbers: { r: 3, q: -0.5 } }, at: 1000 },
  ];
  const [r, q] = toNumberLines(said);
  assert.deepEqual(r?.measured, [
    { at: -1000, value: 1 },
    { at: 0, value: 3 },
  ]);
  assert.deepEqual([r?.low, r?.high, r?.color], [0.8, 3.2, "own"]);
  assert.deepEqual(q?.measured, [{ at: 0, value: -0.5 }]);
  assert.ok(q && q.low < -0.5 && q.high > -0.5, "one number has a scale too");
});

test("a removed name has no line, and a sample without facts has no numbers", () => {
  assert.deepEqual(
    toNumberLines([
      { about: { numbers: { r: 1 } }, at: 0 },
      { about: {}, at: 100 },
    ]),
    [],
  );
  assert.deepEqual(toNumberLines([]), []);
});

test("a long name is cut", () => {
  const [line] = toNumberLines([{ about: { numbers: { "distance to the wall": 1 } }, at: 0 }]);
  assert.deepEqual([line?.name, line?.label], ["distance to the wall", "distance to t\u2026"]);
});
