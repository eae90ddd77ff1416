import assert from "node:assert/strict";
import { test } from "node:test";
import { PlotData } from "../../robowidgets/js/plot/data.ts";
import { decodePlot, type Rows } from "../../robowidgets/js/plot/frame.ts";
import { digitsWithin, toDigits, toGroups, toScale } from "../../robowidgets/js/plot/groups.ts";
import { toValue } from "../../robowidgets/js/plot/legend.ts";
import { holding, spread, toDifference, toLabels } from "../../robowidgets/js/plot/names.ts";
import { measure, merged, readingAt, timeBeside } from "../../robowidgets/js/plot/rows.ts";
import { follows, type Looking, seen, wholeOf } from "../../robowidgets/js/plot/span.ts";
import { toPairs } from "../../robowidgets/js/plot/xy.ts";
import { FakeModel } from "./models.ts";

function rowsOf(times: number[], values: number[], counts = values.map((v) => Number(!Number.isNaN(v)))): Rows {
  const sums = values.map((value) => value || 0);
  const [one, two, three, four] = [times, values, counts, sums].map((column) => new Float64Array(column));
  return { total: times.length, times: one, values: two, counts: three, sums: four } as Rows;
}

/** The bytes of a frame, as `robowidgets/plots/frame.py` packs them. */
function packed(edition: number, span: number[], columns: number, total: number, rows: Rows): DataView {
  const { times, values, counts, sums } = rows;
  const head = [edition, 0, 100, ...span, columns, 1, total, times.length];
  return new DataView(new Float64Array([...head, ...times, ...values, ...counts, ...sums]).buffer);
}

const LINE = rowsOf([0, 1, 2, 3.5, 5], [4, NaN, -1, NaN, 2], [1, 0, 1, -1, 1]);

test("a reading is the last value up to a time, at its own time, and never interpolated", () => {
  assert.deepEqual(readingAt(LINE, 0.99), { time: 0, value: 4 });
  assert.deepEqual(readingAt(LINE, 1.5), { time: 1, value: NaN });
  assert.deepEqual(readingAt(LINE, 4.9), { time: 2, value: -1 });
  assert.deepEqual(readingAt(LINE, 5), { time: 5, value: 2 });
  assert.equal(readingAt(LINE, -0.1), null);
});

test("steps go from value to value, over gaps too, and not to a silence", () => {
  assert.equal(timeBeside(LINE, 0, 1), 1);
  assert.equal(timeBeside(LINE, 2, 1), 5);
  assert.equal(timeBeside(LINE, 5, -1), 2);
  assert.equal(timeBeside(LINE, 5, -10), 0);
  assert.equal(timeBeside(LINE, 5, 1), undefined);
});

test("least, mean and greatest belong to the visible span, and include values that the page lacks", () => {
  assert.deepEqual(measure(LINE, [0, 5]), { least: -1, mean: 5 / 3, most: 4 });
  assert.deepEqual(measure(LINE, [1.5, 5]), { least: -1, mean: 0.5, most: 2 });
  assert.equal(measure(LINE, [2.5, 4]), null);
  assert.equal(measure(LINE, [1, 1]), null);
  const thin: Rows = { ...rowsOf([0, 10], [1, 3]), counts: new Float64Array([1, 9]), sums: new Float64Array([1, 39]) };
  assert.deepEqual(measure(thin, [0, 10]), { least: 1, mean: 4, most: 3 });
});

test("the detailed part replaces the coarse rows", () => {
  const part = rowsOf([2.5, 3, 3.2, 3.4, 4.5], [9, 5, 6, 7, 9]);
  const { times, values } = merged(rowsOf([0, 2, 3.1, 5], [0, 2, 3, 5]), part, [3, 4]);
  assert.deepEqual([...times], [0, 2, 3, 3.2, 3.4, 5]);
  assert.deepEqual([...values], [0, 2, 5, 6, 7, 5]);
});

test("the newest seconds are on show while values arrive, until the user selects a span or freezes", () => {
  const live: Looking = { whole: [0, 100], view: null, live: true, window: 30, frozenAt: null };
  assert.deepEqual(seen(live), [70, 100]);
  assert.equal(follows(live), true);
  assert.deepEqual(seen({ ...live, window: 300 }), [0, 100]);
  assert.deepEqual(seen({ ...live, window: null }), [0, 100]);
  assert.deepEqual(seen({ ...live, frozenAt: 50 }), [20, 50]);
  assert.deepEqual(wholeOf({ ...live, frozenAt: 50 }), [0, 50]);
  assert.equal(follows({ ...live, frozenAt: 50 }), false);
  assert.deepEqual(seen({ ...live, view: [3, 4] }), [3, 4]);
  assert.deepEqual(seen({ ...live, live: false }), [0, 100]);
  assert.deepEqual(seen({ ...live, whole: [2, 2] }), [2, 3]);
});

test("lines of one unit share a graph, distinguished by their pens, with any names", () => {
  const groups = toGroups(["a", "toString", "b", "c"], { units: { a: "m", b: "m", c: "s" } });
  assert.deepEqual(
    groups.map(({ unit, entries }) => [unit, entries.map(({ index }) => index)]),
    [
      ["m", [0, 2]],
      ["", [1]],
      ["s", [3]],
    ],
  );
  const entries = toGroups([..."abcdef"], { units: {}, off: ["b"], ghosts: ["f"] })[0]?.entries ?? [];
  assert.deepEqual(
    entries.map(({ left }) => left),
    ["", "off", "", "", "", ""],
  );
  assert.equal(new Set(entries.filter(({ left }) => !left).map(({ pen }) => pen.dash.join())).size, 4);
  assert.deepEqual(entries.at(-1)?.pen, entries[0]?.pen);
});

test("a graph has at most four lines and a plot three graphs, and switching lines off makes room", () => {
  const left = (off: string[]) =>
    toGroups([..."abcdef"], { units: {}, off }).flatMap(({ entries }) => entries.map((entry) => entry.left));
  assert.deepEqual(left([]), ["", "", "", "", "crowded", "crowded"]);
  assert.deepEqual(left(["a"]), ["off", "", "", "", "", "crowded"]);
  const units = { a: "m", b: "s", c: "V", d: "A", e: "m" };
  const groups = toGroups([..."abcde"], { units }).map(({ entries }) => entries.map((entry) => entry.left));
  assert.deepEqual(groups, [["", ""], [""], [""], ["crowded"]]);
});

test("a line is named by the part that distinguishes it", () => {
  assert.deepEqual(toLabels(["/odom.twist.twist.angular.z", "/imu.angular_velocity.z"]), ["odom", "imu"]);
  assert.deepEqual(toLabels(["/odom.twist.twist.linear.x", "/odom.twist.twist.linear.y"]), ["x", "y"]);
  assert.deepEqual(toLabels(["/odom.twist.linear.x", "/odom.pose.position.x"]), ["linear.x", "position.x"]);
  assert.deepEqual(toLabels(["v", "set"]), ["v", "set"]);
  const odom = "/odom.twist.twist.linear.x";
  assert.deepEqual(toLabels([odom, `d/dt ${odom}`, `${odom} (b.mcap)`]), ["odom", "d/dt odom", "odom (b.mcap)"]);
});

test("a line alone in its graph has the name of its topic only if no other graph shows the topic", () => {
  const turn = "/imu/data.angular_velocity.z";
  const force = ["/imu/data.linear_acceleration.x", "/imu/data.linear_acceleration.y"];
  assert.deepEqual(toLabels([turn], [turn, ...force]), ["z"]);
  assert.deepEqual(toLabels([turn], [turn, "/imu/data.linear_acceleration.z"]), ["angular_velocity.z"]);
  assert.deepEqual(toLabels([turn], [turn, `d/dt ${turn}`, "/odom.twist.twist.linear.x"]), ["data"]);
  const units = { [turn]: "rad/s", ...Object.fromEntries(force.map((name) => [name, "m/s\u00b2"])) };
  const groups = toGroups([turn, ...force], { units });
  assert.deepEqual(
    groups.map(({ entries }) => entries.map(({ label }) => label)),
    [["z"], ["x", "y"]],
  );
});

test("a difference is named by the parts in which two lines differ", () => {
  assert.equal(toDifference(["nearest (fast)", "nearest (slow run)"]), "fast \u2212 slow run");
  assert.equal(toDifference(["odom", "cmd_vel"]), "odom \u2212 cmd_vel");
  assert.equal(toDifference(["x (fast)", "y (fast)"]), "x (fast) \u2212 y (fast)");
});

test("names at the ends of lines stand apart, in the order of the lines, and within the graph", () => {
  assert.deepEqual(spread([50, 20], 15, 0, 100), [50, 20]);
  assert.deepEqual(spread([50, 52, 51], 15, 0, 100), [50, 80, 65]);
  assert.deepEqual(spread([98, 99], 15, 0, 100), [85, 100]);
});

test("two lines over each other hold each value until the next", () => {
  const { times, xs, ys } = toPairs(rowsOf([0, 2, 4], [1, 2, 3]), rowsOf([1, 2], [7, 8]), [1, 4]);
  assert.deepEqual([...times], [1, 2, 4]);
  assert.deepEqual([...xs], [1, 2, 3]);
  assert.deepEqual([...ys], [7, 8, 8]);
});

test("a condition shows how often and how long it holds in the visible span", () => {
  assert.deepEqual(
    holding(
      [
        [0, 2, ""],
        [5, 6, ""],
        [9, 9, ""],
      ],
      [1, 8],
    ),
    [2, 2],
  );
});

test("a number has a real minus sign, and no digits of rounding", () => {
  assert.equal(toDigits(0.30000001192, 7), "0.3");
  assert.equal(toDigits(-12.5, 4), "\u221212.5");
  assert.equal(toDigits(NaN, 4), "NaN");
});

test("a value has the digits that tell it from the others on show, and a whole number has all", () => {
  const degrees = { least: 48.1234001, mean: 48.12365, most: 48.1299002 };
  assert.equal(toValue(48.12345678, degrees), "48.12345678");
  assert.equal(toDigits(degrees.least, digitsWithin(4, degrees)), "48.1234");
  assert.equal(toDigits(degrees.most, digitsWithin(4, degrees)), "48.1299");
  assert.equal(toValue(0.30000001192, { least: -0.1, mean: 0.1, most: 0.4 }), "0.3");
  assert.equal(toValue(-1_234_567_890, null), "\u22121234567890");
  assert.equal(digitsWithin(7, { least: 1, mean: 1 + Number.EPSILON, most: 1 + Number.EPSILON }), 15);
  assert.equal(digitsWithin(7, { least: 5, mean: 5, most: 5 }), 7);
});

test("the numbers of a scale differ, however large they are and however small the step is", () => {
  assert.deepEqual(
    [0, 0.25, -0.5].map((value) => toScale(value, 0.25)),
    ["0.00", "0.25", "\u22120.50"],
  );
  assert.deepEqual(
    [2e6, -4e6].map((value) => toScale(value, 1e6)),
    ["2.0e+6", "\u22124.0e+6"],
  );
  assert.deepEqual(
    [12345000, 12345500].map((value) => toScale(value, 500)),
    ["12345000", "12345500"],
  );
  assert.deepEqual(
    [48.12345, 48.123452].map((value) => toScale(value, 2e-6)),
    ["48.123450", "48.123452"],
  );
  assert.deepEqual(
    [2e-7, 4e-7].map((value) => toScale(value, 2e-7)),
    ["2.0e-7", "4.0e-7"].map((t) => t.replace("-", "\u2212")),
  );
  assert.deepEqual(
    [1.7e9 + 0.1, 1.7e9 + 0.2].map((value) => toScale(value, 0.1)),
    ["\u2026000000.1", "\u2026000000.2"],
  );
});

test("a part is requested only if the whole line lacks values, and a part of other lines is ignored", () => {
  const model = new FakeModel({ _lines: packed(1, [0, 100], 10, 3, rowsOf([0, 50, 100], [1, 2, 3])) });
  const data = new PlotData(model.model, new AbortController().signal);
  assert.equal(data.lacks([0, 1], 500), false);
  model.receive({ _lines: packed(1, [0, 100], 10, 9999, rowsOf([0, 50, 100], [1, 2, 3])) });
  assert.equal(data.lacks([0, 100], 10), false);
  assert.equal(data.lacks([0, 10], 10), true);
  model.receive({ _detail: packed(1, [0, 10], 10, 9999, rowsOf([0, 5], [7, 8])) });
  assert.equal(data.lacks([0, 10], 10), false);
  assert.equal(data.lacks([0, 10], 20), true);
  assert.deepEqual([...(data.lines[0]?.values ?? [])], [7, 8, 2, 3]);
  model.receive({ _lines: packed(2, [0, 100], 10, 9999, rowsOf([0, 50, 100], [1, 2, 3])) });
  assert.deepEqual([...(data.lines[0]?.values ?? [])], [1, 2, 3]);
});

test("an empty trait is not a frame", () => {
  assert.equal(decodePlot(new DataView(new ArrayBuffer(0))), null);
});
