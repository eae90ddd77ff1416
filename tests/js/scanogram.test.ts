import assert from "node:assert/strict";
import { test } from "node:test";
import { Blocks, cellAt } from "../../robowidgets/js/scanogram/blocks.ts";
import * as data from "../../robowidgets/js/scanogram/data.ts";
import { angleLabels, drawTimes } from "../../robowidgets/js/scanogram/draw_axes.ts";
import { layOut } from "../../robowidgets/js/scanogram/layout.ts";
import { toRaster } from "../../robowidgets/js/scanogram/paint.ts";
import { pointAt } from "../../robowidgets/js/scanogram/point.ts";
import { angleTicks, selectedRays, toRows } from "../../robowidgets/js/scanogram/rows.ts";
import { runs } from "../../robowidgets/js/scanogram/scene.ts";
import { State } from "../../robowidgets/js/scanogram/state.ts";
import {
  describeMark,
  describePlace,
  describeSelection,
  describeUnread,
  toFacts,
  toShare,
} from "../../robowidgets/js/scanogram/text.ts";
import { toCount } from "../../robowidgets/js/shared/format.ts";
import type { Theme } from "../../robowidgets/js/shared/theme.ts";
import { toTime, toX } from "../../robowidgets/js/shared/time_axis.ts";
import { moved, timeTicks, zoomed } from "../../robowidgets/js/shared/time_span.ts";
import { DEGREE } from "./laser.ts";
import { FakeModel } from "./models.ts";

const SWEEP = { angleMin: -1, angleIncrement: 0.1, count: 21, minRange: 0.1, maxRange: 10, far: 10, byAngle: false };

/** Bytes as Python packs them, amid a larger message. */
function pack(facts: object, arrays: Record<string, Float64Array | Float32Array | Uint16Array>): DataView {
  const kinds = { Float64Array: "f8", Float32Array: "f4", Uint16Array: "u2" } as Record<string, string>;
  const listed = Object.entries(arrays).map(([name, a]) => [name, kinds[a.constructor.name], a.length]);
  const text = new TextEncoder().encode(JSON.stringify({ ...facts, arrays: listed }));
  const parts = Object.values(arrays).map((a) => new Uint8Array(a.buffer, a.byteOffset, a.byteLength));
  const size = 4 + text.length + parts.reduce((sum, part) => sum + part.length, 0);
  const bytes = new Uint8Array(3 + size);
  new DataView(bytes.buffer).setUint32(3, text.length, true);
  let at = 7;
  for (const part of [text, ...parts]) {
    bytes.set(part, at);
    at += part.length;
  }
  return new DataView(bytes.buffer, 3, size);
}

function cells(count: number, pause: number, from = 0) {
  const starts = Float64Array.from({ length: count }, (_, i) => from + i * pause);
  return { starts, ends: starts.map((start) => start + pause) };
}

/** 100 cells of 8 scans, 0.1 s each, and all rays at 5 m but one. */
function coarse(edition = 1): DataView {
  const codes = new Uint16Array(100 * 21).fill(data.toCode(5, SWEEP));
  codes[40 * 21 + 6] = data.toCode(0.5, SWEEP);
  const facts = {
    ...{
      angle_min: -1,
      angle_increment: 0.1,
      range_min: 0.1,
      range_max: 10,
      far: 10,
      by_angle: false,
      ray_count: 21,
      edition,
    },
    ...{
      scan_count: 800,
      begin: 0,
      duration: 80,
      pause: 0.1,
      class_counts: [16800, 0, 0, 0, 0],
      colors: [0.5, 5],
      pixel: "nearest",
    },
    ...{ level: 3, first: 0, ray_step: 1 },
  };
  return pack(facts, { ...cells(100, 0.8), cells: codes });
}

/** 40 single scans from 30 s on, as the very floats: 0.512 m in one. */
function fine(edition = 1): DataView {
  const ranges = new Float32Array(40 * 21).fill(5);
  ranges[25 * 21 + 6] = 0.512;
  const facts = { edition, span: [30.5, 33], level: 0, first: 300, ray_step: 1 };
  return pack(facts, { ...cells(40, 0.1, 30), cells: ranges });
}

function known() {
  const whole = data.decodeWhole(coarse());
  return { whole, blocks: new Blocks(whole) };
}

test("codes are in the order in which they are shown, as in Python", () => {
  const ranges = [0.1, 10, -Infinity, 11, 0, NaN, Infinity];
  const codes = ranges.map((range) => data.toCode(range, SWEEP));
  assert.deepEqual(codes, [1, 65_001, 0, 65_532, 65_532, 65_533, 65_534]);
  for (const range of [0.1, 2.5, 9.99]) {
    assert.ok(Math.abs(data.toRange(data.toCode(range, SWEEP), SWEEP) - range) < 0.001);
  }
});

test("a frame amid other bytes is read", () => {
  const { whole } = known();
  assert.deepEqual(whole.sweep, SWEEP);
  assert.equal(whole.block.size, 8);
  assert.equal(whole.block.rays, 21);
  assert.equal(whole.speed, null);
  const { block } = data.decodeDetail(fine(), SWEEP);
  assert.equal(block.ranges.length, 40 * 21);
  assert.equal(block.codes[0], data.toCode(5, SWEEP));
});

test("a ray is the nearest of several scans until the scans are known", () => {
  const { whole, blocks } = known();
  const far = blocks.at(32.1, 6);
  assert.equal(far?.scans, 8);
  assert.equal(far?.exact, false);
  assert.match(describePlace(far as never, 0, SWEEP).details, /nearest of 8 scans/);
  assert.equal(describePlace(far as never, 0, SWEEP).distance, "0.50 m");
  blocks.add(data.decodeDetail(fine(), whole.sweep));
  const near = blocks.at(32.55, 6);
  assert.deepEqual([near?.scan, near?.scans, near?.exact], [325, 1, true]);
  assert.equal(near?.range, Math.fround(0.512));
  assert.match(describePlace(near as never, 0, SWEEP).details, /32\.50 s {2}scan 325/);
  assert.match(describePlace(far as never, 0, SWEEP, "median").details, /median of 8 scans/);
  assert.equal(blocks.at(80.5, 6), null, "after the last scan there is no place");
});

/** Two parts of a drive of 1000 scans: three scans from 10 s on, and three from 50 s on, 5 m away. */
function parts() {
  const facts = {
    ...{ angle_min: -1, angle_increment: 0.1, range_min: 0.1, range_max: 10, far: 10, by_angle: false, ray_count: 21 },
    ...{ edition: 1, scan_count: 6, drive_scans: 1000, begin: 0, duration: 100, pause: 0.1, pixel: "nearest" },
    ...{ class_counts: [126, 0, 0, 0, 0], colors: [0.5, 5], level: 0, first: 0, ray_step: 1 },
  };
  const starts = Float64Array.from([10, 10.1, 10.2, 50, 50.1, 50.2]);
  const ranges = new Float32Array(6 * 21).fill(5);
  const whole = data.decodeWhole(pack(facts, { starts, ends: starts.map((start) => start + 0.1), cells: ranges }));
  return { whole, blocks: new Blocks(whole) };
}

test("between the parts of a drive no number is shown, and the pop-up says that no scan was read", () => {
  const { whole, blocks } = parts();
  const found = blocks.at(10.15, 6);
  assert.deepEqual([found?.time, found?.scan, found?.range], [10.1, null, 5]);
  assert.equal(describePlace(found as never, 0, SWEEP).details.includes("scan "), false, "its number is unknown");
  assert.equal(blocks.at(30, 6), null);
  assert.equal(blocks.at(10.31, 6), null);
  assert.equal(describeUnread(30).distance, "not read");
  assert.match(describeUnread(30).details, /30\.00 s\nno scan/);
  assert.deepEqual(toFacts(whole).slice(0, 2), [`6 of ${toCount(1000)} scans`, "21 rays"]);
  assert.match(describeSelection([0, 20], blocks.count([0, 20]), true), /3 scans read$/);
});

test("pointing between the parts of a drive shows no number of a part", () => {
  const { whole, blocks } = parts();
  const rows = toRows(whole.sweep);
  const axis = { span: [0, 100], left: 0, width: 200 };
  const band = { top: 0, height: 21 };
  const layout = { left: 0, width: 200, scans: band, speeds: [], touch: null, states: [] };
  const scene = { layout, axis, rows, toRow: () => 6, toY: () => 14 } as never;
  const at = (time: number) => pointAt({ x: 2 * time, y: 14 }, scene, { whole, blocks } as never);
  assert.deepEqual([at(10.15)?.words.distance, at(10.15)?.row], ["5.00 m", 6]);
  assert.match(at(9.8)?.words.details ?? "", /10\.00 s/, "the scan of this pixel, with its own time");
  assert.deepEqual([at(30)?.words.distance, at(30)?.row], ["not read", null]);
  const all = { whole: known().whole, blocks: known().blocks } as never;
  assert.equal(pointAt({ x: 190, y: 14 }, scene, all), null, "a whole drive has no pop-up after its last scan");
});

test("a scan narrower than its pixel is found within the pixel, with its own time, and none farther away", () => {
  const { blocks } = parts();
  assert.equal(blocks.near(9.8, 6, 0.25)?.time, 10);
  assert.equal(blocks.near(10.5, 6, 0.25)?.time, 10.2);
  assert.equal(blocks.near(49.9, 6, 0.25)?.time, 50);
  for (const time of [9.7, 10.6, 30, 49.7]) assert.equal(blocks.near(time, 6, 0.25), null);
});

test("only the columns of the parts have colors", () => {
  const { whole, blocks } = parts();
  const { codes, width } = toRaster(blocks.all, toRows(whole.sweep), [0, 100], 100, 1);
  const colored = Array.from({ length: width }, (_, x) => x).filter((x) => codes[x] !== data.NO_SCAN);
  assert.deepEqual(colored, [10, 50]);
});

test("details of other scans than the ones on show are left out", () => {
  const { whole, blocks } = known();
  blocks.add(data.decodeDetail(fine(2), whole.sweep));
  assert.equal(blocks.at(32.55, 6)?.scans, 8);
});

test("more detail is wanted only if Python has more", () => {
  const { whole, blocks } = known();
  assert.equal(blocks.wants([0, 80], 80), false);
  assert.equal(blocks.wants([0, 80], 200), true);
  assert.equal(blocks.wants([31, 32], 80), true);
  blocks.add(data.decodeDetail(fine(), whole.sweep));
  assert.equal(blocks.wants([31, 32], 80), false);
});

test("the cursor steps from scan to scan", () => {
  const { whole, blocks } = known();
  blocks.add(data.decodeDetail(fine(), whole.sweep));
  const round = (time: number) => Math.round(time * 1000) / 1000;
  assert.equal(round(blocks.step(31, 1)), 31.1);
  assert.equal(round(blocks.step(31.05, -1)), 31);
  assert.equal(round(blocks.step(31, -1)), 30.9);
  assert.equal(round(blocks.step(31, 10)), 32);
  assert.equal(round(blocks.step(33.9, 1)), 34.4, "at its end the coarser one goes on");
  assert.equal(round(blocks.step(30, -1)), 29.6);
  assert.equal(round(blocks.step(79.2, 1)), 79.2);
  assert.equal(blocks.step(0, -1), 0);
});

test("a cell without length is still found, and a gap is empty", () => {
  const block = { ...known().whole.block, startsAt: Float64Array.of(0, 1, 5), endsAt: Float64Array.of(1, 1, 6) };
  assert.deepEqual(
    [0.5, 1, 3, 5.5, 7].map((time) => cellAt(block, time)),
    [0, 1, -1, 2, -1],
  );
});

test("the nearest reading is in the picture at any width and height", () => {
  const { whole, blocks } = known();
  const near = data.toCode(0.5, SWEEP);
  const rows = toRows(whole.sweep);
  for (const [width, height] of [
    [1, 1],
    [7, 5],
    [100, 21],
    [1000, 400],
  ] as const) {
    const raster = toRaster(blocks.all, rows, [0, 80], width, height);
    assert.equal(raster.height, Math.min(21, height));
    const at = raster.codes.indexOf(near);
    assert.ok(at >= 0, `at ${width} by ${height}`);
    const [x, y] = [at % width, Math.floor(at / width)];
    assert.equal(x, Math.floor((32 * width) / 80 + 1e-9));
    assert.equal(y, raster.height - 1 - Math.floor((6 * raster.height) / 21));
  }
});

test("of several rays in a pixel, one that is too close to measure is shown, and it has no distance", () => {
  const [far, close, nothing] = [5, -Infinity, Infinity].map((range) => data.toCode(range, SWEEP)) as [
    number,
    number,
    number,
  ];
  const { whole } = known();
  const codes = new Uint16Array(21).fill(nothing);
  codes.set([far, close, far, far, data.toCode(0, SWEEP)]);
  const block = {
    ...whole.block,
    size: 1,
    rayStep: 1,
    rays: 21,
    startsAt: Float64Array.of(0),
    endsAt: Float64Array.of(1),
    codes,
  };
  assert.equal(toRaster([block], toRows(whole.sweep), [0, 1], 1, 1).codes[0], close);
  const blocks = new Blocks({ ...whole, block: { ...block, size: 8 } });
  const texts = [0, 1, 4, 5].map((ray) => {
    const place = blocks.at(0.5, ray);
    return place && [Number.isNaN(place.range), describePlace(place, 0, SWEEP).details.split("\n").at(-1)];
  });
  assert.deepEqual(texts, [
    [false, "nearest of 8 scans"],
    [true, "nearest of 8 scans"],
    [true, "one or more of 8 scans"],
    [true, "all of 8 scans"],
  ]);
});

test("columns with finer detail are painted from it, and a gap stays empty", () => {
  const { whole, blocks } = known();
  blocks.add(data.decodeDetail(fine(), whole.sweep));
  const { codes } = toRaster(blocks.all, toRows(whole.sweep), [32, 33.6], 16, 21);
  const line = codes.subarray(14 * 16, 15 * 16);
  assert.deepEqual(
    Array.from(line, (code) => code < data.toCode(1, SWEEP)),
    [...Array(5).fill(false), true, ...Array(10).fill(false)],
  );
  const beyond = toRaster(blocks.all, toRows(whole.sweep), [79.2, 81.2], 10, 1).codes;
  assert.deepEqual(
    Array.from(beyond, (code) => code === data.NO_SCAN),
    [...Array(4).fill(false), ...Array(6).fill(true)],
  );
});

test("a pixel shows the median of its cells, and a missing scan does not count", () => {
  const codes = Uint16Array.of(5, 9, 7, 1, data.NO_SCAN, 3, data.NOTHING_IN_RANGE, 2, data.NOTHING_IN_RANGE);
  const block = { size: 1, first: 0, rayStep: 1, rays: 3, codes, ranges: new Float32Array() };
  const { starts, ends } = cells(3, 1);
  const rows = toRows({ ...SWEEP, count: 3 });
  const shown = (width: number, height: number, pixel: "nearest" | "median") =>
    Array.from(toRaster([{ ...block, startsAt: starts, endsAt: ends }], rows, [0, 3], width, height, pixel).codes);
  // Ray 2 is above: 7, 3, nothing. Ray 1: 9, no scan, 2. Ray 0: 5, 1, nothing.
  assert.deepEqual(shown(1, 3, "median"), [7, 2, 5]);
  assert.deepEqual(shown(1, 3, "nearest"), [3, 2, 1]);
  assert.deepEqual(shown(3, 3, "median"), shown(3, 3, "nearest"), "where nothing is shared both are the same");
  assert.deepEqual(shown(1, 1, "median"), [5], "rays that share a line, too");
});

test("in a low picture the indices give way first, then the last speeds", () => {
  const axes = ["linear.x", "linear.y", "angular.z"];
  const whole = { ...known().whole, speed: { axes }, touch: {} } as unknown as data.Whole;
  const laid = (height: number) => {
    const { scans, indices, speeds, touch } = layOut({ width: 700, height }, whole, 0);
    assert.ok(touch && scans.height >= 90, `${scans.height} at ${height}`);
    return [indices, speeds.length];
  };
  assert.deepEqual(
    [laid(380), laid(306), laid(240), laid(200), laid(160)],
    [
      [true, 3],
      [false, 3],
      [false, 2],
      [false, 1],
      [false, 0],
    ],
  );
  assert.equal(
    layOut({ width: 700, height: 306 }, { ...whole, speed: null } as data.Whole, 0).scans.height >= 200,
    true,
  );
});

test("angles grow upwards, and forward is in the middle of a circle", () => {
  const circle = toRows({ ...SWEEP, angleMin: 0, angleIncrement: (2 * Math.PI) / 360, count: 360 });
  assert.equal(circle.rayOf[0], 180);
  assert.equal(circle.rayOf[180], 0);
  assert.equal(circle.rowOf[90], 270);
  const clockwise = toRows({ ...SWEEP, angleMin: 1, angleIncrement: -0.1 });
  assert.deepEqual([clockwise.rayOf[0], clockwise.rayOf[20]], [20, 0]);
  assert.ok(clockwise.angles.every((angle, i) => i === 0 || angle > (clockwise.angles[i - 1] as number)));
  assert.deepEqual(toRows({ ...SWEEP, count: 0 }).rayOf, []);
});

test("with few rays each is labelled once", () => {
  const few = toRows({ ...SWEEP, angleMin: -0.5, angleIncrement: 0.5, count: 3 });
  assert.deepEqual(angleTicks(few, 300, 34), [0, 1, 2]);
});

test("indices are hidden if scans count their rays differently", () => {
  const { blocks } = known();
  const place = blocks.at(31, 6);
  assert.ok(place);
  const said = (byAngle: boolean) => describePlace(place, 0, { ...SWEEP, byAngle }).expression;
  assert.deepEqual([said(false), said(true)], ["ranges[6]", ""]);
  assert.equal(toRows({ ...SWEEP, byAngle: true }).byAngle, true);
});

test("a span of rays that a circle cuts is two ranges of rows", () => {
  const circle = toRows({ ...SWEEP, angleMin: 0, angleIncrement: (2 * Math.PI) / 360, count: 360 });
  assert.deepEqual(runs(circle, 10, 20), [[190, 199]]);
  assert.deepEqual(runs(circle, 170, 190), [
    [0, 9],
    [350, 359],
  ]);
});

test("angle labels have round angles and room", () => {
  const circle = toRows({ ...SWEEP, angleMin: 0, angleIncrement: (2 * Math.PI) / 360, count: 360 });
  const ticks = angleTicks(circle, 240, 34).map((row) => circle.rayOf[row]);
  assert.deepEqual(ticks, [180, 270, 0, 90]);
  assert.deepEqual(angleTicks(toRows({ ...SWEEP, count: 1, angleIncrement: 0 }), 240, 34), [0]);
});

test("zooming keeps the time under the pointer and stays within the whole", () => {
  assert.deepEqual(zoomed([0, 80], 0.5, 20, [0, 80], 0.1), [10, 50]);
  assert.deepEqual(zoomed([10, 50], 4, 20, [0, 80], 0.1), [0, 80]);
  const [start, end] = zoomed([10, 10.2], 0.01, 10.1, [0, 80], 0.1);
  assert.ok(Math.abs(end - start - 0.1) < 1e-9);
  assert.deepEqual(moved([10, 20], -50, [0, 80]), [0, 10]);
  assert.deepEqual(moved([10, 20], 500, [0, 80]), [70, 80]);
  const axis = { span: [10, 20] as [number, number], left: 64, width: 500 };
  assert.equal(toTime(axis, toX(axis, 13)), 13);
  assert.deepEqual([toTime(axis, 0), toTime(axis, 9999)], [10, 20]);
});

test("times have no more decimals than they need", () => {
  assert.deepEqual(
    timeTicks([0, 50], 5)
      .map(({ text }) => text)
      .slice(0, 2),
    ["0 s", "10 s"],
  );
  assert.deepEqual(
    timeTicks([41.1, 41.4], 3).map(({ text }) => text),
    ["41.1 s", "41.2 s", "41.3 s", "41.4 s"],
  );
});

test("a long recording has its times in hours, minutes and seconds, at round steps of them", () => {
  const said = (span: [number, number], count: number, whole: number) =>
    timeTicks(span, count, whole).map(({ text }) => text);
  assert.deepEqual(said([0, 20_000], 6, 20_000), ["0:00:00", "1:00:00", "2:00:00", "3:00:00", "4:00:00", "5:00:00"]);
  assert.deepEqual(said([3590, 3650], 4, 20_000), ["1:00:00", "1:00:15", "1:00:30", "1:00:45"]);
  assert.deepEqual(said([3599.9, 3600.2], 3, 20_000), ["0:59:59.9", "1:00:00.0", "1:00:00.1", "1:00:00.2"]);
  assert.deepEqual(said([0, 600], 4, 600)[1], "5:00");
  assert.deepEqual(said([0, 60], 4, 60), ["0:00", "0:15", "0:30", "0:45", "1:00"]);
  assert.deepEqual(said([0, 59], 4, 59)[1], "20 s");
  assert.deepEqual(said([0, 900_000], 4, 900_000)[1], "120:00:00");
});

test("a small share is never shown as 0 %, nor nearly all as 100 %", () => {
  const shares = [0, 1, 10, 90, 9_999, 10_000].map((count) => toShare(count, 10_000));
  assert.deepEqual(shares, ["0 %", "< 0.1 %", "0.1 %", "0.9 %", "99 %", "100 %"]);
});

test("the text of a selection has its rays and the number of its scans", () => {
  const { blocks } = known();
  assert.equal(describeSelection([8, 16], blocks.count([8, 16])), "8.00 \u2013 16.00 s · about 80 scans");
  assert.equal(
    describeSelection([1, 2, 10, 20], { scans: 1, exact: true }),
    "1.00 \u2013 2.00 s · [10] to [19] · 1 scan",
  );
});

function open(values: Record<string, unknown>) {
  const fake = new FakeModel({ time: 0, selection: null, view: null, color_range: null, ...values });
  const controller = new AbortController();
  return { fake, state: new State(fake.model, controller.signal), end: () => controller.abort() };
}

test("finer detail is requested once, and used when it arrives", () => {
  const { fake, state, end } = open({ _frame: coarse() });
  state.look([30.5, 33], 500);
  state.look([30.5, 33], 500);
  assert.deepEqual(fake.saved, [{ _wanted: [30.5, 33, 500] }]);
  fake.receive({ _detail: fine() });
  assert.equal(state.blocks?.at(32.55, 6)?.exact, true);
  end();
  assert.equal(fake.listening, 0);
});

test("a reload finds the detail that it had", () => {
  const { state, end } = open({ _frame: coarse(), _detail: fine(), view: [30.5, 33] });
  assert.equal(state.blocks?.at(32.55, 6)?.exact, true);
  assert.deepEqual(state.view, [30.5, 33]);
  end();
});

test("the cursor goes from mark to mark of any source", () => {
  const { fake, state, end } = open({ _frame: coarse(), marks: [] });
  let told = 0;
  state.listen(() => told++, new AbortController().signal);
  fake.receive({
    marks: [
      [20, 21, "slow"],
      [20, 40, "near"],
      [50, 50, "bump"],
    ],
    time: 20,
  });
  assert.equal(told, 1);
  assert.deepEqual([state.markBeside(1), state.markBeside(-1)], [50, undefined]);
  fake.receive({ time: 50.5 });
  assert.deepEqual([state.markBeside(1), state.markBeside(-1)], [undefined, 50]);
  end();
});

test("marks stand above the scans, and their pop-up has name and span", () => {
  const { marks, scans } = layOut({ width: 700, height: 380 }, known().whole, 30);
  assert.ok(marks.top > 30 && marks.top + marks.height <= scans.top);
  const { expression, distance } = describeMark({ start: 20, end: 40, name: "near" });
  assert.deepEqual([expression, distance], ["near", "20.00 \u2013 40.00 s"]);
});

test("before there are scans there is an axis and nothing on it", () => {
  const { state, end } = open({});
  assert.equal(state.whole, null);
  assert.deepEqual(state.view, [0, 1]);
  end();
});

test("rays are selected between two rows, up to the closing ray of a circle", () => {
  for (const [angleMin, angleIncrement] of [
    [0, DEGREE],
    [2 * Math.PI, -DEGREE],
  ] as const) {
    const rows = toRows({ ...SWEEP, angleMin, angleIncrement, count: 360 });
    const rowOf = (ray: number) => rows.rowOf[ray] as number;
    assert.deepEqual(selectedRays(rows, rowOf(10), rowOf(40)), [10, 41]);
    assert.deepEqual(selectedRays(rows, rowOf(40), rowOf(10)), [10, 41]);
    assert.deepEqual(selectedRays(rows, rowOf(20), rowOf(350)), [0, 21]);
    assert.deepEqual(selectedRays(rows, rowOf(350), rowOf(20)), [350, 360]);
  }
});

test("the last number of the time axis stands whole within the picture, on a tick at its very end too", () => {
  for (const width of [260, 380, 400, 700]) {
    const layout = layOut({ width, height: 300 }, null, 0);
    const written: [string, number][] = [];
    const context = {
      measureText: (text: string) => ({ width: 7 * text.length }),
      fillRect: () => {},
      fillText: (text: string, x: number) => written.push([text, x + 3.5 * text.length]),
    } as unknown as CanvasRenderingContext2D;
    const axis = { span: [0, 120] as [number, number], left: layout.left, width: layout.width };
    drawTimes(context, axis, layout, 120, -10, {} as Theme);
    assert.equal(written.at(-1)?.[0], "2:00");
    for (const [text, end] of written) assert.ok(end <= width, `${text} ends at ${end} of ${width}`);
  }
});

test("a label at an end of the axis never covers its neighbour", () => {
  const rows = toRows({ ...SWEEP, angleMin: -Math.PI / 2, angleIncrement: Math.PI / 180, count: 180 });
  for (const hasIndices of [false, true]) {
    for (let height = hasIndices ? 180 : 60; height <= 600; height += 7) {
      const middles = angleLabels(rows, { top: 40, height }, hasIndices).flatMap(({ middle }) => middle ?? []);
      const steps = middles.slice(1).map((middle, i) => Math.abs(middle - (middles[i] as number)));
      assert.ok(Math.min(...steps) >= (hasIndices ? 25 : 13), `${height} px: ${middles}`);
    }
  }
});
