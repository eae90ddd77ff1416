import assert from "node:assert/strict";
import { test } from "node:test";
import { History } from "../../robowidgets/js/shared/history.ts";

const SECONDS = 30;

/** A history with samples numbered from 0, at a rate. */
function filled(count: number, { hertz = 10, size = 8, seconds = SECONDS } = {}) {
  const history = new History();
  let next = 0;
  const add = (more: number) => {
    for (let i = 0; i < more; i++, next++) {
      const bytes = new DataView(new ArrayBuffer(size));
      bytes.setFloat64(0, next);
      history.add(bytes, (1000 * next) / hertz, seconds);
    }
  };
  add(count);
  return { history, add, numbers: () => history.moments.map(({ bytes }) => bytes.getFloat64(0)) };
}

function range(from: number, to: number): number[] {
  return Array.from({ length: to - from }, (_, i) => from + i);
}

test("the history keeps so many seconds", () => {
  assert.deepEqual(filled(200).numbers(), range(0, 200));
  assert.deepEqual(filled(1000).numbers(), range(699, 1000));
  assert.deepEqual(filled(1000, { seconds: 5 }).numbers(), range(949, 1000));
});

test("a fast source keeps 20 samples for each second", () => {
  assert.deepEqual(filled(5000, { hertz: 60 }).numbers(), range(4400, 5000));
});

test("large samples are kept up to 8 MB, and always the newest", () => {
  assert.deepEqual(filled(100, { size: 1e6 }).numbers(), range(92, 100));
  assert.deepEqual(filled(3, { size: 9e6 }).numbers(), [2]);
});

test("without seconds only the newest is kept", () => {
  const { history, add, numbers } = filled(50, { seconds: 0 });
  assert.deepEqual(numbers(), [49]);
  history.freeze(5000);
  add(50);
  assert.deepEqual(numbers(), [49, 99]);
});

for (const [what, options, before, after] of [
  ["seconds", { hertz: 10 }, range(699, 1000), range(1000, 1299)],
  ["samples", { hertz: 60 }, range(400, 1000), range(1000, 1599)],
  ["bytes", { size: 1e6 }, range(992, 1000), range(1000, 1007)],
] as const) {
  test(`frozen, the history drops nothing, takes as much again, and always has the newest: ${what}`, () => {
    const { history, add, numbers } = filled(1000, options);
    assert.deepEqual(numbers(), before);
    history.freeze(history.moments.at(-1)?.at ?? 0);
    for (let i = 0; i < 50; i++) {
      add(100);
      const newest = 1000 + 100 * (i + 1) - 1;
      assert.deepEqual(numbers().slice(0, before.length), before);
      assert.equal(numbers().at(-1), newest);
      assert.ok(numbers().length <= before.length + after.length + 1);
    }
    assert.deepEqual(numbers(), [...before, ...after, 5999]);
    history.release(SECONDS);
    assert.equal(numbers().at(-1), 5999);
    add(1);
    assert.ok(numbers().length <= Math.max(601, before.length));
    assert.deepEqual(numbers().slice(-2), [5999, 6000]);
  });
}

test("released, it has the same bounds as before", () => {
  const { history, add, numbers } = filled(600, { hertz: 60 });
  history.freeze(history.moments.at(-1)?.at ?? 0);
  add(600);
  assert.equal(numbers().length, 1200);
  history.release(SECONDS);
  assert.deepEqual(numbers(), range(600, 1200));
});

test("the sample found at page load is dropped with the first new sample, unless frozen", () => {
  const history = new History();
  const [found, newer] = [new DataView(new ArrayBuffer(8)), new DataView(new ArrayBuffer(8))];
  history.add(found, Number.NaN, SECONDS);
  history.freeze(0);
  history.add(newer, 10, SECONDS);
  assert.deepEqual(
    history.moments.map(({ bytes }) => bytes),
    [found, newer],
  );
  history.release(SECONDS);
  assert.deepEqual(
    history.moments.map(({ bytes }) => bytes),
    [newer],
  );
});
