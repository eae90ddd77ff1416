import assert from "node:assert/strict";
import { test } from "node:test";
import { toReason, toReasons, toShell } from "../../robowidgets/js/sheet/odd.ts";
import {
  cutOf,
  evenly,
  filtered,
  firstOfEach,
  type Moment,
  sorted,
  toCode,
  toMoments,
} from "../../robowidgets/js/sheet/order.ts";
import { LIT, unpack } from "../../robowidgets/js/sheet/pictures.ts";

const MOMENTS = toMoments(
  {
    file: [1, 0, 0, 1],
    topic: [0, 0, 0, 0],
    start: [5, 1, 9, 2],
    end: [6, 1, 9.5, 4],
    time: [5.5, 1, 9.2, 3.1234],
    date: [null, 1e9, 2e9, null],
    nearest: [0.2, null, 0.15, 0.29],
    index: [3, null, 7, 9],
    value: [null, -0.31234, null, 2],
    silent: ["", "/scan", "", ""],
  },
  [
    ["/runs/run_2.mcap", "run_2.mcap"],
    ["/runs/run_10.mcap", "run_10.mcap"],
  ],
  ["/scan, /odom"],
);
const numbers = (moments: Moment[]) => moments.map(({ number }) => number);

test("moments are sorted by a column in both directions, files by their numbers, and missing values are last", () => {
  assert.deepEqual(numbers(sorted(MOMENTS, "nearest")), [2, 0, 3, 1]);
  assert.deepEqual(numbers(sorted(MOMENTS, "-nearest")), [3, 0, 2, 1]);
  assert.deepEqual(numbers(sorted(MOMENTS, "file")), [1, 2, 0, 3]);
  assert.deepEqual(numbers(sorted(MOMENTS, "held")), [1, 2, 0, 3]);
  assert.deepEqual(numbers(sorted(MOMENTS, "-value")), [3, 1, 0, 2]);
  assert.deepEqual(numbers(sorted(MOMENTS, "-date")), [2, 1, 0, 3]);
});

test("a filter of a column compares numbers, matches a part of a text, and passes everything while it is incomplete", () => {
  const chosen = (filters: Record<string, string>) => numbers(filtered(MOMENTS, filters));
  assert.deepEqual(chosen({ nearest: "< 0.25" }), [0, 2]);
  assert.deepEqual(chosen({ nearest: "0.15 to 0.2" }), [0, 2]);
  assert.deepEqual(chosen({ nearest: "<" }), [0, 1, 2, 3]);
  assert.deepEqual(chosen({ nearest: "0.1" }), [2]);
  assert.deepEqual(chosen({ file: "RUN_1" }), [0, 3]);
  assert.deepEqual(chosen({ file: "run_10", held: "> 1.5" }), [3]);
  assert.deepEqual(chosen({ date: "2001-09" }), [1]);
});

test("one for each file is the first, and an even choice fills a screen", () => {
  assert.deepEqual(numbers(firstOfEach(sorted(MOMENTS, "nearest"))), [2, 0]);
  const { step, chosen } = evenly(Array(2318).fill(MOMENTS[0]), 24);
  assert.equal(step, 97);
  assert.equal(chosen.length, 24);
});

test("all pictures are cut to about five times the limit", () => {
  const reach = (nearest: number | null) => cutOf([{ ...(MOMENTS[0] as Moment), nearest }]);
  assert.deepEqual([0.2998, 0.3, 0.5, 1.2, 20].map(reach), [1.5, 1.5, 2.5, 7.5, 100]);
  assert.equal(reach(null), null);
});

test("the code opens the sample of the nearest thing, or the span, and never the previous sample", () => {
  const [first, gap, , odd] = MOMENTS as [Moment, Moment, Moment, Moment];
  assert.equal(toCode(first), 'robowidgets.open("/runs/run_10.mcap").at("/scan", 5.5)');
  assert.equal(toCode(odd), 'robowidgets.open("/runs/run_10.mcap").at("/scan", 3.124)');
  assert.equal(toCode(gap), 'robowidgets.open("/runs/run_2.mcap")[1:1.001]');
});

/**
 * Bytes packed by robowidgets/fleet/_pictures.py; tests/unit/fleet/test_sheet.py checks that it packs the same bytes.
 */
const PACKED =
  "05000000010003000000003f0000003e6f12033b05000000640004800000" +
  "66616374730007000000020002000000" +
  "80bf000020410000000000000000" +
  "0000803fcdcccc3d";

test("unpacked pictures are the ones that Python has packed", () => {
  const bytes = Uint8Array.from(PACKED.match(/../g) as string[], (byte) => Number.parseInt(byte, 16));
  // At an odd place of a message.
  const message = new Uint8Array(bytes.length + 3);
  message.set(bytes, 3);
  const found = unpack(new DataView(message.buffer, 3));
  assert.deepEqual([...found.keys()], [5, 7]);
  assert.equal(found.get(5)?.words, "facts");
  assert.deepEqual([...(found.get(5)?.values ?? [])], [100, LIT | 4, 0]);
  assert.deepEqual(found.get(5)?.facts, [0.5, 0.125]);
  assert.deepEqual(found.get(7)?.form, "line");
  assert.deepEqual([...(found.get(7)?.values ?? [])], [1, Math.fround(0.1)]);
});

test("files that were not read whole are listed by reason, the most frequent first, without names and numbers", () => {
  const odd = [
    "a.bag has no laser scans",
    "the recording was cut off: read 270 messages, up to 13.4 s",
    "the recording was cut off: read 12 messages, up to 1.5 s",
    "was cut off before its first message (13 bytes), nothing can be saved",
    "a chunk of 13 bytes is damaged",
  ].map((problem) => ({ path: "/runs/day/a.bag", name: "day/a.bag", problem, is_read: true }));
  assert.deepEqual(odd.map(toReason).slice(0, 2), ["has no laser scans", odd[1]?.problem]);
  assert.equal(
    toReasons(odd),
    "and 5 more: the recording was cut off (2), has no laser scans (1), was cut off before its first message (1) and others",
  );
  assert.equal(toReasons(odd.slice(4)), "and 1 more: a chunk of … bytes is damaged (1)");
});

test("a path that is copied for a shell runs nothing", () => {
  assert.equal(toShell("/runs/my run.mcap"), '"/runs/my run.mcap"');
  assert.equal(toShell("/runs/`id`.mcap"), "'/runs/`id`.mcap'");
  assert.equal(toShell("C:\\runs\\a.bag"), '"C:\\runs\\a.bag"');
  assert.equal(toShell("/runs/$(id)'s.mcap"), "'/runs/$(id)'\\''s.mcap'");
});
