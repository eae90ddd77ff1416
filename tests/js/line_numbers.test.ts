import assert from "node:assert/strict";
import { test } from "node:test";
import { changedLines, type Editor, replaceIn } from "../../robowidgets/js/lines/cell.ts";
import { wordsOf } from "../../robowidgets/js/lines/change.ts";
import { summaryOf } from "../../robowidgets/js/lines/compared.ts";
import { partsOf, rangeOf, textIn, toNumber } from "../../robowidgets/js/lines/numbers.ts";

test("a number in a source may have a space after its sign and underscores", () => {
  assert.deepEqual(["- 2", "1_000", "0.25"].map(toNumber), [-2, 1000, 0.25]);
});

test("a slider goes from zero to twice the number, in round steps that Python takes", () => {
  const taken = /^-?\d{1,10}(\.\d{1,12})?$/;
  for (const text of [
    "0.6",
    "-0.8",
    "3",
    "0",
    "0.0",
    "1e-3",
    "100.0",
    "1_000",
    "- 2",
    "3.14159",
    "1e-11",
    "999999999",
  ]) {
    const range = rangeOf(text);
    const value = Number(text.replace(/[\s_]/g, ""));
    assert.ok(range.low <= value && value <= range.high, text);
    for (const share of [0, 0.21, 0.5, 1]) {
      const shown = textIn(range, range.low + share * (range.high - range.low));
      assert.match(shown, taken, text);
      assert.equal(shown.includes("."), /[.e]/.test(text), `${text} gives ${shown}`);
    }
    const steps = (range.high - range.low) / range.step;
    assert.ok(steps >= 10 && steps <= 900, `${text} has ${steps} steps`);
  }
  assert.deepEqual(rangeOf("0.2"), { low: 0, high: 0.4, step: 0.01, digits: 2 });
  assert.deepEqual(rangeOf("-3"), { low: -10, high: 0, step: 1, digits: 0 });
});

test("a text has no needless zeros, and stays within the slider", () => {
  const range = rangeOf("0.2");
  assert.deepEqual(
    [0.3, 0.123456, -5, 99, 0.1 + 0.2, 0.0000001].map((value) => textIn(range, value)),
    ["0.3", "0.12", "0.0", "0.4", "0.3", "0.0"],
  );
  assert.equal(textIn(rangeOf("-0.8"), -0.001), "0.0");
  assert.equal(textIn(rangeOf("20"), 7.6), "8");
});

test("the parts of a line hold its numbers where Python found them, and all of its text", () => {
  const line = 'x = "☃🤖 0.5", -0.8  # 0.5';
  const parts = partsOf(line, [[0, 14, "-0.8", ""]]);
  assert.equal(parts.map(([, text]) => text).join(""), line);
  assert.deepEqual(parts.filter(([, , number]) => number)[0]?.slice(0, 2), ["number", "-0.8"]);
  assert.deepEqual(parts.find(([, text]) => text === "# 0.5")?.[0], "comment");
});

function editorOf(text: string, readOnly = false): Editor & { text: string } {
  return {
    text,
    get state() {
      return { doc: this.text, readOnly };
    },
    dispatch({ changes }) {
      for (const { from, to, insert } of [...changes].reverse()) {
        this.text = this.text.slice(0, from) + insert + this.text.slice(to);
      }
    },
  };
}

const BEFORE = ["def go(scan):", "    if scan.distance() < 0.6:", "        return 0", "    return 1"];
const AFTER = ["def go(scan):", "    if scan.distance() < 0.75:", "        return 0", "    return 12"];

test("lines are replaced in the one cell that has them, and nowhere else", () => {
  const cells = ["import a\n", `x = 1\n${BEFORE.join("\n")}\n\ny = 2`, "def go(scan):"].map((text) => editorOf(text));
  assert.equal(replaceIn(cells, [["gone", "", "", ""], BEFORE], AFTER), "");
  assert.deepEqual(
    cells.map(({ text }) => text),
    ["import a\n", `x = 1\n${AFTER.join("\n")}\n\ny = 2`, "def go(scan):"],
  );
  assert.equal(changedLines(BEFORE, AFTER), `${AFTER[1]}\n${AFTER[3]}`);
});

test("no cell changes if none or several have the lines, or if it is read-only, and the reason is the true one", () => {
  const text = BEFORE.join("\n");
  for (const [why, ...texts] of [
    ["its cell cannot be reached from here"],
    ["its cell cannot be reached from here", "x", `${text}5`, `y = ${text}`],
    ["more than one cell of this page contains its function", "x", text, text],
    ["its cell contains its function more than once", `${text}\n${text}`],
  ]) {
    const cells = texts.map((one) => editorOf(one));
    assert.equal(replaceIn(cells, [BEFORE], AFTER), why);
    assert.deepEqual(
      cells.map((one) => one.text),
      texts,
    );
  }
  assert.equal(replaceIn([editorOf(text, true)], [BEFORE], AFTER), "its cell is read-only");
});

test("the state of a number has words", () => {
  const effect = { press: "a", text: "0.3", steps: 200, seconds: 9.96, otherwise: 12, failed: 0 };
  assert.equal(wordsOf({ ...effect, state: "tried" }), "another speed in 12 of 200 steps of the last 10.0 s");
  assert.equal(
    wordsOf({ ...effect, state: "tried", otherwise: 0 }),
    "the same speeds in all 200 steps of the last 10.0 s",
  );
  assert.match(
    wordsOf({ ...effect, state: "tried", failed: 3, error: "E: <b>" }),
    /^it would fail in 3 of .*: E: <b>$/,
  );
  assert.equal(wordsOf({ state: "tried", why: "it uses gripper" }), "without a trial: it uses gripper");
  assert.equal(wordsOf({ state: "driving", text: "0.3", version: 2 }), "0.3 drives, as version 2");
  assert.equal(
    wordsOf({ state: "driving", text: "0.3", version: 2, note: "Stop is pressed" }),
    "0.3 is in version 2; Stop is pressed",
  );
  assert.equal(wordsOf({ state: "back", text: "0.2", version: 3, note: "" }), "0.2 is back, as version 3");
  assert.equal(wordsOf({ state: "refused", why: "it is late" }), "not changed: it is late");
});

test("two versions are compared in words", () => {
  const found = {
    key: "a 3",
    old: 2,
    new: 3,
    steps: 600,
    seconds: 59.94,
    otherwise: 12,
    spans: 2,
    failed: 0,
    error: "",
  };
  assert.equal(summaryOf(found), "version 3 and version 2 differ 2 times, in 12 of 600 steps of the last 59.9 s");
  assert.match(summaryOf({ ...found, otherwise: 0 }), /ask for the same speeds in all 600 steps/);
  assert.match(summaryOf({ ...found, failed: 4, error: "E" }), /; version 3 fails in 4: E$/);
  assert.equal(summaryOf({ key: "a 3", old: 2, new: 3, why: "W" }), "version 3 and version 2 were not compared: W");
});
