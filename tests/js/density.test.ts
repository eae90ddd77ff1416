import assert from "node:assert/strict";
import { test } from "node:test";
import { toDensity } from "../../robowidgets/js/player/density.ts";
import type { Mark } from "../../robowidgets/js/shared/marks.ts";

test("marks with room between them stay single, at their places and with their labels", () => {
  const marks: Mark[] = [
    [10, 20, "near"],
    [50, 50, "turn"],
  ];
  const found = toDensity(marks, 0, 100, 200);
  assert.deepEqual(
    found.map(({ left, width, count, label }) => [left, width, count, label]),
    [
      [20, 20, 1, "near"],
      [100, 3, 1, "turn"],
    ],
  );
});

test("ten thousand marks take at most one element per bin of the slider, and the fullest bin is the darkest", () => {
  const marks: Mark[] = Array.from({ length: 10_000 }, (_, i) => [
    (i / 10_000) ** 2 * 100,
    (i / 10_000) ** 2 * 100,
    "m",
  ]);
  const found = toDensity(marks, 0, 100, 300);
  assert.ok(found.length <= 100);
  const [first, last] = [found[0], found.at(-1)];
  assert.equal(first?.share, 1);
  assert.ok((last?.share ?? 1) < 0.6);
  assert.equal(first?.label, "10000 marks, 0.00 to 99.98 s");
  for (const { left, width } of found) assert.ok(left >= 0 && left + width <= 303);
});

test("marks that touch are one density, without a gap and no wider than they are", () => {
  const found = toDensity(
    [
      [10, 12, "a"],
      [11, 30, "b"],
      [90, 91, "c"],
    ],
    0,
    100,
    100,
  );
  assert.equal(found.at(-1)?.label, "c");
  const joined = found.filter(({ count }) => count === 2);
  assert.equal(joined[0]?.left, 10);
  assert.equal(
    joined.reduce((sum, { width }) => sum + width, 0),
    20,
  );
});
