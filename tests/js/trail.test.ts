import assert from "node:assert/strict";
import { test } from "node:test";
import { spreadAt, spreadOf } from "../../robowidgets/js/laser/spread.ts";
import { placedWords, placeScans } from "../../robowidgets/js/laser/trail_layer.ts";
import { decodeScan } from "../../robowidgets/js/shared/frames/scan.ts";
import { Stream } from "../../robowidgets/js/shared/stream.ts";
import { near, scanOf } from "./laser.ts";
import { FakeModel } from "./models.ts";
import { frameOf, toNumber, vectors } from "./vectors.ts";

test("the spread of each ray is the same as in Python", () => {
  assert.ok(vectors.spreads.length > 2);
  for (const [rows, expected] of vectors.spreads) {
    const found = spreadOf(rows.map((ranges) => scanOf(ranges.map(toNumber), { maxRange: 10 })));
    const wanted = expected.map(toNumber);
    for (const [i, metres] of wanted.entries()) {
      const value = Math.fround(spreadAt(found, i));
      assert.ok(Object.is(value, metres), `ray ${i} of ${rows.length} scans: ${value}, and not ${metres}`);
    }
  }
});

test("scans with another number of rays do not count for the spread", () => {
  const found = spreadOf([scanOf([5]), scanOf([1, 2]), scanOf([1, 3])]);
  assert.deepEqual([found.count, spreadAt(found, 0)], [2, 0]);
  assert.ok(near(spreadAt(found, 1), 0.45));
});

test("the footer names the source of the poses", () => {
  const pose: [number, number, number] = [1, 0, 0];
  assert.equal(placedWords({ pose }), "by odometry");
  assert.equal(placedWords({ pose, placed_by: "tf" }), "by tf");
  assert.equal(placedWords({}), "scanner\u2019s frame");
});

const [first, second, now] = [scanOf([1]), scanOf([2]), scanOf([3])];

test("without a pose of the scan on show, earlier ones stand at the scanner", () => {
  const placed = placeScans([
    { scan: first, pose: [1, 2, 3] },
    { scan: now, pose: undefined },
  ]);
  assert.deepEqual(placed, [{ scan: first, x: 0, y: 0, turn: 0 }]);
});

test("with a pose, earlier scans are placed by their poses, and scans without one are left out", () => {
  const placed = placeScans([
    { scan: first, pose: undefined },
    { scan: second, pose: [3, 1, 0] },
    { scan: now, pose: [2, 1, Math.PI / 2] },
  ]);
  assert.equal(placed.length, 1);
  const [{ scan, x, y, turn } = assert.fail()] = placed;
  assert.equal(scan, second);
  // One metre east of a robot that looks north is one metre to its right.
  assert.ok(near(x, 0) && near(y, -1) && near(turn, -Math.PI / 2));
});

function frame(sequence: number): DataView {
  const bytes = frameOf("laser");
  bytes.setFloat64(0, sequence, true);
  return bytes;
}

test("the last scans end at the one on show, frozen and stepped back, or as a player gives them", () => {
  const fake = new FakeModel({ paused: false, history: 30, _about: {}, _source: {} });
  const controller = new AbortController();
  const stream = new Stream(fake.model, decodeScan, controller.signal);
  const numbers = (count: number) =>
    stream.last(count).map((one) => [stream.frameOf(one).sequence, one.about.pose?.[0]]);
  assert.deepEqual(numbers(3), []);
  for (let i = 1; i <= 5; i++) fake.receive({ _frame: frame(i), _about: { pose: [i / 10, 0, 0] } });
  assert.deepEqual(numbers(3), [
    [3, 0.3],
    [4, 0.4],
    [5, 0.5],
  ]);
  const [newest = assert.fail()] = stream.last(1);
  assert.equal(stream.frameOf(newest), stream.frameOf(newest), "decoded once");
  stream.freeze();
  fake.receive({ _frame: frame(6) });
  stream.step(-3);
  assert.deepEqual(numbers(3), [
    [1, 0.1],
    [2, 0.2],
  ]);
  fake.receive({ _recent: [{ bytes: frame(42), at: NaN, about: {} }] });
  assert.deepEqual(numbers(3), [[42, undefined]]);
  fake.receive({ _recent: [{ bytes: {}, at: null, about: {} }] });
  assert.deepEqual(numbers(3), [], "a saved notebook holds no bytes");
  controller.abort();
});
