import assert from "node:assert/strict";
import { test } from "node:test";
import { fold, type Row, Rows, rowAt } from "../../robowidgets/js/events/rows.ts";
import { countLevels, describeRow, toExtent, toLine, toSpoken, toTimeText } from "../../robowidgets/js/events/text.ts";

const RECORDED = { span: [0, 30], start: null };

function rowOf(number: number, text: string, changed: Partial<Row> = {}): Row {
  const [seconds, until] = [number, changed.seconds ?? number];
  return { number, seconds, until, level: 20, source: "", text, topic: "", count: 1, length: text.length, ...changed };
}

function packed(rows: Row[]): DataView {
  const listed = rows.map((r) => [r.number, r.seconds, r.until, r.level, r.source, r.text, r.topic, r.count, r.length]);
  return new DataView(new TextEncoder().encode(JSON.stringify(listed)).buffer);
}

const texts = (rows: Row[]) => rows.map(({ text }) => text);

test("rows that are sent seldom give way to newer versions of them, and the forgotten ones go", () => {
  const rows = new Rows();
  const old = packed([rowOf(0, "a"), rowOf(1, "b"), rowOf(2, "c")]);
  const fresh = packed([rowOf(2, "c", { count: 3 }), rowOf(3, "d")]);
  const all = rows.all(old, fresh);
  assert.deepEqual(
    all.map(({ text, count }) => [text, count]),
    [
      ["a", 1],
      ["b", 1],
      ["c", 3],
      ["d", 1],
    ],
  );
  assert.equal(rows.all(old, fresh), all);
  assert.deepEqual(texts(rows.all(old, fresh, 2)), ["c", "d"]);
  assert.deepEqual(texts(rows.all(new DataView(new ArrayBuffer(0)), null)), []);
});

test("a filter takes a level and all of its words, in text, source or topic", () => {
  const rows = new Rows();
  const all = [
    rowOf(0, "Lost the line", { level: 30, source: "follower" }),
    rowOf(1, "lost", { level: 40, topic: "/rosout" }),
    rowOf(2, "fine"),
  ];
  const shown = (level: "DEBUG" | "WARN" | "ERROR", words = "") => texts(rows.shown(all, { level, words }));
  assert.deepEqual(shown("DEBUG"), ["Lost the line", "lost", "fine"]);
  assert.deepEqual(shown("ERROR"), ["lost"]);
  assert.deepEqual(shown("DEBUG", "LOST follow"), ["Lost the line"]);
  assert.deepEqual(shown("DEBUG", "rosout"), ["lost"]);
  assert.deepEqual(shown("WARN", "fine"), []);
});

test("rows that become equal neighbours in a filter are one row", () => {
  const rows = [rowOf(0, "a", { count: 2 }), rowOf(1, "a", { seconds: 5 }), rowOf(2, "a", { level: 30 })];
  assert.deepEqual(
    fold(rows).map(({ count, seconds, until }) => [count, seconds, until]),
    [
      [3, 0, 5],
      [1, 2, 2],
    ],
  );
});

test("the row of a time is the last that began by then", () => {
  const rows = [rowOf(1, "a"), rowOf(2, "b")];
  assert.deepEqual(
    [0.5, 1, 1.5, 9].map((time) => rowAt(rows, time)),
    [-1, 0, 0, 1],
  );
});

test("a text is one line, and shows how much of it was left out", () => {
  assert.equal(toLine(rowOf(0, " a\n\tb  c ")), "a b c");
  assert.equal(toLine(rowOf(0, "x".repeat(500))).length, 401);
  const cut = rowOf(12, "xx", { length: 3000, source: "node", topic: "/rosout", level: 40, count: 14, until: 20 });
  assert.equal(
    describeRow(cut, RECORDED),
    "14 times from 12.000 s to 20.000 s \u00B7 error \u00B7 node \u00B7 /rosout \u00B7 the first 2 of 3\u202f000 characters",
  );
  assert.deepEqual(toSpoken(cut, RECORDED), ["error", "12.00 s", "node", "xx", "14 times"]);
});

test("times of a recording count from its start, and live times are of the day", () => {
  assert.equal(toTimeText(12.5, RECORDED), "12.50 s");
  assert.equal(toTimeText(75, { span: [0, 90], start: null }), "1:15.00");
  assert.match(toTimeText(1.25, { span: [], start: 1_700_000_000 }), /^\d\d:\d\d:21\.25$/);
});

test("levels are counted with repeated events, and the extent shows how many rows are hidden", () => {
  const rows = [rowOf(0, "a", { level: 50 }), rowOf(1, "b", { level: 30, count: 14 }), rowOf(2, "c")];
  assert.deepEqual(countLevels(rows), { errors: 1, warnings: 14, others: 1 });
  assert.equal(toExtent(1, 1, 0), "1 row");
  assert.equal(toExtent(3, 12, 40), "3 of 12 rows \u00B7 40 older left out");
});
