import assert from "node:assert/strict";
import { test } from "node:test";
import { decodeMessage, type Packed, type Value } from "../../robowidgets/js/message/frame.ts";
import { Seen, toTable } from "../../robowidgets/js/message/table.ts";
import {
  nameOf,
  noteOf,
  toCode,
  toExact,
  toReadable,
  toSaid,
  toSpoken,
  toWhole,
} from "../../robowidgets/js/message/text.ts";
import type { Node } from "../../robowidgets/js/message/traits.ts";
import {
  elementsOf,
  type Field,
  find,
  isSame,
  summaryOf,
  toFields,
  toNumber,
} from "../../robowidgets/js/message/tree.ts";
import { toTreeLines } from "../../robowidgets/js/message/tree_lines.ts";
import { frameOf } from "./vectors.ts";

const NOTHING = new DataView(new ArrayBuffer(0));

function number(name: string, type = "float64", more: Partial<Node> = {}): Node {
  return { name, kind: "number", type, ...more };
}

function fieldsOf(nodes: Node[], values: Value[], numbers: DataView = NOTHING): Field[] {
  return toFields(nodes, { values, numbers } as Packed);
}

/** An array of float32 as Python packs it. */
function array(name: string, values: number[], more: Partial<Node> = {}): Field {
  const numbers = new DataView(new Float32Array(values).buffer);
  const finite = values.filter(Number.isFinite).map(Math.fround);
  const nans = values.filter(Number.isNaN).length;
  const summary = [
    values.length,
    ...(finite.length ? [Math.min(...finite), Math.max(...finite)] : [null, null]),
    nans,
    values.length - finite.length - nans,
    0,
  ];
  const node: Node = { name, kind: "numbers", type: "float32", ...more };
  return fieldsOf([node], [summary], numbers)[0] as Field;
}

const QUATERNION: Node = {
  name: "orientation",
  kind: "message",
  type: "geometry_msgs/msg/Quaternion",
  children: ["x", "y", "z", "w"].map((name) => number(name)),
};

test("a number has the fewest digits that give the same float32 or float64", () => {
  assert.equal(toExact(Math.fround(0.1), "float32"), "0.1");
  assert.equal(toExact(Math.fround(0.1), "float64"), "0.10000000149011612");
  assert.equal(toExact(Math.fround(16777217.5), "float32"), "16777218");
  assert.equal(toExact(Math.fround(1.2345678), "float32"), "1.2345678");
  assert.equal(toExact(-0.5, "float64"), "\u22120.5");
  assert.equal(toExact("1152921504606846977", "int64"), "1152921504606846977");
  assert.equal(toExact("-1152921504606846977", "int64"), "\u22121152921504606846977");
  assert.equal(toExact("-inf", "float64"), "\u2212inf");
});

test("each float32 is read back from its digits", () => {
  for (let i = 0; i < 2000; i++) {
    const value = Math.fround((Math.sin(i * 12.9898) * 43758.5453) % 1) * 10 ** ((i % 40) - 20);
    const text = toExact(Math.fround(value), "float32").replaceAll("\u2212", "-");
    assert.equal(Math.fround(Number(text)), Math.fround(value));
  }
});

test("a long number is shown with seven digits, and in the foot with all of them", () => {
  const [field] = fieldsOf([number("z", "float64", { unit: "m/s\u00b2" })], [9.824123456789012]);
  assert.equal(toReadable(9.824123456789012, "float64"), "9.824123");
  assert.equal(toWhole(field as Field), "9.824123456789012 m/s\u00b2");
});

test("a tiny number has an exponent, and one kind of minus sign", () => {
  assert.equal(toReadable(-8.4831234e-10, "float64", 4), "\u22128.483e\u221210");
  assert.equal(toReadable(-0.0000016412345, "float64", 4), "\u22121.641e\u22126");
  assert.equal(toReadable(0.00064331234, "float64", 4), "0.0006433");
  assert.equal(toExact(-1.5e-10, "float64"), "\u22121.5e\u221210");
});

test("a missing measurement is not shown as a number, and never as zero", () => {
  const said = toSaid(fieldsOf([number("charge", "float32", { unit: "Ah" })], ["nan"])[0] as Field);
  assert.deepEqual([said.text, said.unit, said.isNone], ["not measured (NaN)", "", true]);
  assert.equal(toSaid(fieldsOf([number("x")], [null])[0] as Field).text, "no value");
  assert.equal(toNumber("nan"), NaN);
  assert.equal(toNumber("-inf"), -Infinity);
  assert.equal(toNumber(null), NaN);
});

test("a named number is shown by its name, with the number next to it; bits by all their names", () => {
  const names = { "0": "OK", "2": "ERROR" };
  const said = toSaid(fieldsOf([number("level", "uint8", { names })], [2])[0] as Field);
  assert.deepEqual([said.text, said.more], ["ERROR", "2"]);
  const services = { "1": "GPS", "2": "GLONASS", "4": "COMPASS" };
  assert.equal(nameOf(3, services), "GPS + GLONASS");
  assert.equal(nameOf(9, services), "");
  assert.equal(nameOf(3, names), "");
  assert.equal(nameOf(5, undefined), "");
});

test("an array shows its length, its least and greatest value, and the number of missing measurements", () => {
  assert.equal(
    toSaid(array("ranges", [0.5, NaN, 5.25, Infinity, NaN])).text,
    "[5] 0.5 to 5.25, 2 not measured, 1 infinite",
  );
  assert.equal(toSaid(array("ranges", [1, 1])).text, "[2] all 1");
  assert.equal(toSaid(array("ranges", [NaN])).text, "[1] 1 not measured");
  const [empty] = fieldsOf([{ name: "a", kind: "numbers", type: "float32" }], [[0, null, null, 0, 0, 0]]);
  assert.equal(toSaid(empty as Field).text, "[0]");
});

test("a covariance of zeros is unknown, and one of -1 was not measured", () => {
  const zeros = array("orientation_covariance", [0, 0, 0]);
  assert.equal(toSaid(zeros).text, "all 0: not known");
  assert.match(noteOf(zeros), /by the definition the covariance is not known, not zero/);
  assert.equal(toSaid(array("covariance", [-1, 0, 0])).text, "\u22121: not measured");
  assert.equal(noteOf(array("ranges", [0, 0])), "");
});

test("a quaternion shows its yaw, and one that was never set shows nothing", () => {
  const [field] = fieldsOf([QUATERNION], [[0, 0, Math.SQRT1_2, Math.SQRT1_2]]);
  assert.equal(toSaid(field as Field).text, "90.0\u00b0 yaw");
  const lines = toTreeLines([field as Field], {});
  assert.deepEqual(
    lines.slice(-2).map(({ label, derived }) => [label, derived]),
    [
      ["roll", "0.0\u00b0"],
      ["pitch", "0.0\u00b0"],
    ],
  );
  assert.equal(toSaid(fieldsOf([QUATERNION], [[0, 0, 0, 0]])[0] as Field).text, "");
});

test("a vector shows its length, and a position does not", () => {
  const parts = (unit: string) => ["x", "y", "z"].map((name) => number(name, "float64", { unit }));
  const vector = (unit: string, type: string): Node => ({ name: "v", kind: "message", type, children: parts(unit) });
  const said = (node: Node) => toSaid(fieldsOf([node], [[3, 4, 0]])[0] as Field);
  assert.equal(said(vector("m/s", "geometry_msgs/msg/Vector3")).text, "5");
  assert.equal(said(vector("m", "geometry_msgs/msg/Point")).text, "");
});

test("a stamp is a time of day, a short time seconds", () => {
  const time = (value: number[]) =>
    toSaid(fieldsOf([{ name: "stamp", kind: "time", type: "time", unit: "s" }], [value])[0] as Field);
  assert.deepEqual([time([1750000033, 197000000]).text, time([1750000033, 197000000]).unit], ["15:07:13.197", "UTC"]);
  assert.equal(time([33, 5_000_000]).text, "33.005");
  assert.equal(time([-1, 500_000_000]).text, "\u22120.500");
  assert.equal(time([0, 0]).text, "0");
});

test("code reads a field by any name as its program does", () => {
  const inner: Node = { name: "a", kind: "message", type: "", children: [number("b c"), number("x")] };
  const [field] = fieldsOf([inner], [[1, 2]]);
  const [odd, plain] = field?.children ?? [];
  assert.equal(toCode(plain as Field, false), "message.a.x");
  assert.equal(toCode(plain as Field, true), 'message["a"]["x"]');
  assert.equal(toCode(odd as Field, false), 'message.a["b c"]');
  const [keyword, digit] = fieldsOf([number("class"), number("1st")], [1, 2]);
  assert.equal(toCode(keyword as Field, false), 'getattr(message, "class")');
  assert.equal(toCode(digit as Field, false), 'message["1st"]');
  assert.equal(toCode(elementsOf(array("ranges", [1, 2]), 1, 2)[0] as Field, false), "message.ranges[1]");
  const [alone] = fieldsOf([number("pose.position[2].x")], [1]);
  assert.equal(toCode(alone as Field, false), "message.pose.position[2].x");
  assert.equal(toCode(alone as Field, true), 'message["pose"]["position"][2]["x"]');
});

test("fields near the root are unfolded as long as there is room, and the user's choice comes first", () => {
  const children = Array.from({ length: 50 }, (_, i) => number(`f${i}`));
  const nodes: Node[] = [
    { name: "point", kind: "message", type: "", children: [number("x")] },
    { name: "many", kind: "message", type: "", children },
    { name: "folded", kind: "message", type: "", folded: 2000 },
  ];
  const fields = fieldsOf(nodes, [[1], children.map(() => 0), []]);
  const keys = (folds = {}) => toTreeLines(fields, folds).map(({ key }) => key);
  assert.deepEqual(keys(), ["point", "point.x", "many", "folded"]);
  assert.deepEqual(keys({ point: false }), ["point", "many", "folded"]);
  assert.equal(keys({ many: true }).length, 54);
  assert.equal(toTreeLines(fields, { folded: true }).at(-1)?.label, "loading \u2026");
});

test("a long array unfolds in parts of 32, and parts that were not sent have their place", () => {
  const long = array(
    "ranges",
    Array.from({ length: 70 }, (_, i) => i),
  );
  const lines = toTreeLines([long], { ranges: true, "ranges[64:70]": true });
  assert.deepEqual(
    lines.map(({ key }) => key),
    [
      "ranges",
      "ranges[0:32]",
      "ranges[32:64]",
      "ranges[64:70]",
      ...[64, 65, 66, 67, 68, 69].map((i) => `ranges[${i}]`),
    ],
  );
  const [far] = fieldsOf([{ name: "data", kind: "numbers", type: "uint8" }], [[307200, 0, 9, 0, 0, -1]]);
  assert.match(toTreeLines([far as Field], { data: true }).at(-1)?.label ?? "", /data in Python has all/);
});

test("fields are found by their path, also in arrays", () => {
  const [message] = fieldsOf([QUATERNION], [[1, 2, 3, 4]]);
  assert.equal(find([message as Field], "orientation.z")?.value, 3);
  assert.equal(find([array("ranges", [5, 6])], "ranges[1]")?.value, 6);
  assert.equal(find([message as Field], "orientation.q"), undefined);
  assert.equal(find([array("ranges", [5, 6])], "ranges[7]"), undefined);
});

test("changes are found to the last bit, also in arrays, and NaN equals NaN", () => {
  const one = (value: Value) => fieldsOf([number("x")], [value])[0] as Field;
  assert.ok(isSame(one(1), one(1)));
  assert.ok(!isSame(one(1), one(1.0000000000000002)));
  assert.ok(isSame(one("nan"), one("nan")));
  assert.ok(!isSame(array("a", [0, 1, 5]), array("a", [0, 2, 5])));
  assert.ok(isSame(array("a", [0, NaN, 5]), array("a", [0, NaN, 5])));
  const [before] = fieldsOf([QUATERNION], [[0, 0, 0, 1]]);
  assert.ok(!isSame(before as Field, fieldsOf([QUATERNION], [[0, 0, 0.1, 1]])[0]));
  assert.ok(!isSame(one(1), undefined));
});

test("a screen reader gets the path, the value and its unit in words, and the changes", () => {
  const node: Node = {
    name: "angular_velocity",
    kind: "message",
    type: "",
    children: [number("z", "float64", { unit: "rad/s" })],
  };
  const [z] = fieldsOf([node], [[-0.47]])[0]?.children ?? [];
  assert.equal(toSpoken(z as Field, true), "angular velocity, z, \u22120.47 radians per second, changed");
});

function joints(position: number[]): Field[] {
  const names = fieldsOf([{ name: "name", kind: "texts", type: "string" }], [[2, ["wheel", "pan"]]])[0] as Field;
  return [names, array("position", position), array("velocity", [1, NaN]), array("effort", [])];
}

test("joints are rows: a missing value is a dash, a wheel counts turns", () => {
  const seen = new Seen();
  toTable(joints([0, -0.5]), seen);
  const table = toTable(joints([62.5, 0.5]), seen);
  const [wheel, pan] = table?.rows ?? [];
  assert.deepEqual(
    [wheel?.name, wheel?.index, wheel?.cells[0]?.text, wheel?.cells[0]?.more],
    ["wheel", "[0]", "62.5", "9.9 turns"],
  );
  assert.deepEqual(
    pan?.cells.map(({ text }) => text),
    ["0.5", "\u2014", "\u2014"],
  );
  assert.deepEqual(pan?.cells[0]?.bar, { low: -0.5, high: 0.5, value: 0.5, from: 0, ends: ["", ""] });
  assert.equal(pan?.cells[1]?.bar, null);
});

test("a note below joints explains the signs that are there, and no others", () => {
  const whole = (position: number) => [
    ...joints([]).slice(0, 1),
    ...["position", "velocity", "effort"].map((name) => array(name, [position, 1])),
  ];
  const seen = new Seen();
  assert.equal(toTable(whole(0.5), seen)?.note, "");
  assert.equal(toTable(whole(0.7), seen)?.note, "Bars go from the least to the greatest that this page has seen.");
  assert.equal(toTable(joints([0, -0.5]), new Seen())?.note, "\u2014 is not measured (NaN), or not sent.");
});

test("joints without names have their index", () => {
  const none = fieldsOf([{ name: "name", kind: "messages", type: "", count: 0, children: [] }], [[0, []]])[0] as Field;
  const seen = new Seen();
  const sent = (values: number[]) => [none, array("position", values), array("velocity", []), array("effort", [])];
  toTable(sent([1, 2, 3]), seen);
  const rows = toTable(sent([0.5, 2, 3]), seen)?.rows ?? [];
  assert.deepEqual(
    rows.map(({ name, index, cells }) => [name, index, cells[0]?.text]),
    [
      ["", "[0]", "0.5"],
      ["", "[1]", "2"],
      ["", "[2]", "3"],
    ],
  );
  assert.deepEqual(rows[0]?.cells[0]?.bar, { low: 0.5, high: 1, value: 0.5, from: 0.5, ends: ["", ""] });
});

test("a battery shows per cent, its cells, and no bar if the ends are unknown", () => {
  const names = { "2": "DISCHARGING" };
  const fields = fieldsOf(
    [
      number("voltage", "float32"),
      number("percentage", "float32"),
      number("charge"),
      number("power_supply_status", "uint8", { names }),
    ],
    [Math.fround(16.21), Math.fround(0.867), "nan", 2],
  );
  const rows = toTable([...fields, array("cell_voltage", [4, 3])], new Seen())?.rows ?? [];
  const by = Object.fromEntries(rows.map((row) => [row.key, row.cells[0]]));
  assert.deepEqual(
    [by.percentage?.text, by.percentage?.unit, by.percentage?.more],
    ["86.7", "%", "0.867 in the message"],
  );
  assert.equal(by.voltage?.bar, null);
  assert.equal(by.charge?.text, "not measured (NaN)");
  assert.equal(by.power_supply_status?.text, "DISCHARGING");
  assert.equal(by["cell_voltage[1]"]?.bar?.value, 3);
});

test("other messages have no rows", () => {
  assert.equal(toTable(fieldsOf([QUATERNION], [[0, 0, 0, 1]]), new Seen()), null);
  assert.equal(toTable(fieldsOf([number("status")], [1]), new Seen()), null);
});

test("a frame holds the numbers of arrays, whole numbers to the last digit", () => {
  const packed = decodeMessage(frameOf("message"));
  const [field] = fieldsOf(
    [{ name: "ids", kind: "numbers", type: "int64" }],
    [packed.values[4] as Value],
    packed.numbers,
  );
  assert.deepEqual(
    elementsOf(field as Field, 0, 2).map(({ value }) => value),
    [-3, "1152921504606846977"],
  );
  assert.equal(summaryOf(field as Field).most, "1152921504606846977");
});
