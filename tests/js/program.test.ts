import assert from "node:assert/strict";
import { test } from "node:test";
import { toCode, toMode, toNotice, toStep, toValue } from "../../robowidgets/js/program/text.ts";
import type { Program, ProgramTold, Variable } from "../../robowidgets/js/program/traits.ts";

const told = (more: object = {}) => ({ stopped: false, error: "", status: "", ...more }) as ProgramTold;
const program = (more: object = {}) =>
  ({ mode: "running", waiting: "", error: "", note: "", prints: [], ...more }) as unknown as Program;
const slider: Variable = { name: "near", value: 0.5, before: 0.5, low: 0.2, high: 2, unit: "m", whole: false };

test("a speed is written as Python writes it", () => {
  assert.equal(toCode([0.25, -0.30000000000000004, 0], false), "Drive(0.25, -0.3)");
  assert.equal(toCode([0, 1, 0], false), "Drive(0.0, 1.0)");
  assert.equal(toCode([0, 1, 0], true), "None, keeps Drive(0.0, 1.0)");
  assert.equal(toCode([0, 0, -0.07], false), "Drive(0.0, 0.0, lateral=-0.07)");
});

test("Stop comes before all, and a program that does not drive is waiting", () => {
  assert.equal(toMode(told({ stopped: true }), program()), "stopped");
  assert.equal(toMode(told(), program({ waiting: "no scan" })), "waiting");
  assert.equal(toMode(told(), program({ mode: "failed", waiting: "no scan" })), "failed");
  assert.equal(toMode(told({ stopped: true }), program(), false), "not known");
});

test("an error replaces the prints, a note shows only without prints", () => {
  assert.deepEqual(toNotice(told(), program({ error: "line 3: no" })), { text: "line 3: no", isError: true });
  assert.equal(toNotice(told(), program({ note: "replaces avoid" })).text, "replaces avoid");
  assert.equal(toNotice(told(), program({ note: "replaces avoid", prints: [[0, "hello"]] })).text, "");
  const notice = (mode: string) => toNotice(told({ stopped: true }), program({ mode })).text;
  assert.equal(notice("running"), "Zero until you press Allow driving or Run: then it drives on.");
  assert.equal(notice("paused"), "Zero until you press Run.");
});

test("a slider steps by about a hundredth of its range, and shows as many decimals", () => {
  assert.equal(toStep(0.2, 2), 0.01);
  assert.equal(toStep(0, 100), 1);
  assert.equal(toValue(slider), "0.50");
  assert.equal(toValue({ ...slider, low: null, high: null, value: 0.1 + 0.2 }), "0.3");
});

test("a slider of integers steps by one", () => {
  assert.equal(toStep(1, 5, true), 1);
  assert.equal(toValue({ ...slider, low: 1, high: 5, value: 3, whole: true }), "3");
});
