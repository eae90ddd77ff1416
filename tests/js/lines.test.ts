import assert from "node:assert/strict";
import { test } from "node:test";
import type { Host } from "../../robowidgets/js/laser/layer.ts";
import { LitLayer } from "../../robowidgets/js/laser/lit_layer.ts";
import { stretchesOf } from "../../robowidgets/js/lines/graph.ts";
import { tokensOf } from "../../robowidgets/js/lines/python.ts";
import { toTraces } from "../../robowidgets/js/lines/recorded.ts";
import { type Line, type Step, type Steps, tracesOf } from "../../robowidgets/js/lines/steps.ts";
import { light, pointedRays, readsOne } from "../../robowidgets/js/shared/lit.ts";

test("the parts of a line of Python are all of its text", () => {
  const line = `    def f(x=0.5, *a): return "a # b" if x != 1e-3 else r'\\d'  # why "not"`;
  const tokens = tokensOf(line);
  assert.equal(tokens.map(([, text]) => text).join(""), line);
  const of = (kind: string) => tokens.filter(([one]) => one === kind).map(([, text]) => text);
  assert.deepEqual(of("word"), ["def", "return", "if", "else"]);
  assert.deepEqual(of("name"), ["f"]);
  assert.deepEqual(of("text"), ['"a # b"', "r'\\d'"]);
  assert.deepEqual(of("comment"), ['# why "not"']);
  assert.deepEqual(of("number"), ["0.5", "1e", "3"]);
});

test("letters of any language, an open text and odd signs stay as they are", () => {
  for (const line of ["größe = 'ü☃", '\tx = """a', "x = a\\", "", "é$?"]) {
    assert.equal(
      tokensOf(line)
        .map(([, text]) => text)
        .join(""),
      line,
    );
  }
});

function frameOf(key: string, ...levels: (number | null)[]): Steps {
  const steps = levels.map((level, i): Step => {
    const line: Line = [1, "", [], 1, "number", level, []];
    const lines = level === null ? [] : [line];
    return {
      number: i,
      time: i,
      at: i,
      given: [],
      calls: [{ key: "f 1", lines, loops: [], error: null }],
      none: false,
    };
  });
  return { sequence: 1, rate: NaN, arrived: 0, key, steps, total: levels.length, totals: {} };
}

test("a trace has the levels of one version since a time, and a gap where its line was not reached", () => {
  const traces = tracesOf([frameOf("a 1", 9), frameOf("a 2", 0, 5, null, null, 7)], "a 2", 1);
  assert.deepEqual(traces.get("f 1:1"), [
    [1, 5],
    [4, null],
    [4, 7],
  ]);
});

test("neighbouring stretches are one, and a pause ends a stretch", () => {
  const stretches = stretchesOf([
    [0, 1],
    [0.5, 1],
    [1, 0],
    [5, 1],
    [9, null],
  ]);
  assert.deepEqual(stretches, [
    [0, 1],
    [5, 6],
  ]);
});

test("of several lasers only the one whose scan was read is lit, and one without a frame in any case", () => {
  const { signal } = new AbortController();
  const layers = ["front", "rear", ""].map((frame_id) => {
    const stream = { robot: "here", about: { frame_id } };
    const model = { get: () => null, on() {}, off() {} };
    return new LitLayer({ model, stream, card: { redraw() {} }, signal } as unknown as Host);
  });
  const lit = () => layers.map((layer) => Object.keys(layer.painters()).length > 0);
  light("here", [{ runs: [0, 3], nearest: 1, frame: "rear" }]);
  assert.deepEqual(lit(), [false, true, true]);
  light("there", []);
  assert.deepEqual(lit(), [false, true, true]);
  light("here", []);
  assert.deepEqual(lit(), [false, false, false]);
});

test("a pointed or pinned ray of a laser marks the lines that read it, and the player's group stands for a robot", () => {
  const controller = new AbortController();
  const values: Record<string, number | null> = { pinned: null, hovered: null };
  const changes: (() => void)[] = [];
  const model = {
    get: (name: string) => values[name],
    on: (_: string, call: () => void) => changes.push(call),
    off() {},
  };
  const stream = { robot: "", group: "player", about: { frame_id: "front" } };
  new LitLayer({ model, stream, card: { redraw() {} }, signal: controller.signal } as unknown as Host);
  const point = (name: string, index: number | null) => {
    values[name] = index;
    for (const call of changes) call();
  };
  assert.deepEqual(pointedRays("player"), []);
  point("hovered", 7);
  point("pinned", 2);
  const rays = pointedRays("player");
  assert.deepEqual(
    rays.map(({ index }) => index),
    [2, 7],
  );
  assert.deepEqual(pointedRays("another"), []);
  assert.ok(readsOne([{ runs: [0, 1, 5, 8], nearest: -1, frame: "front" }], rays));
  assert.ok(readsOne([{ runs: [2, 3], nearest: -1, frame: "" }], rays));
  assert.ok(!readsOne([{ runs: [2, 3], nearest: -1, frame: "rear" }], rays));
  assert.ok(!readsOne([{ runs: [3, 7], nearest: -1, frame: "front" }], rays));
  point("hovered", null);
  assert.equal(pointedRays("player").length, 1);
  controller.abort();
  assert.deepEqual(pointedRays("player"), []);
});

test("the graph of a line over a recording has its levels at all times", () => {
  const traces = toTraces({ from: 0, to: 2, times: [0, 1], lines: { f: [[3, "flag", [1, null]]] } });
  assert.deepEqual(traces.get("f:3"), {
    kind: "flag",
    trace: [
      [0, 1],
      [1, null],
    ],
  });
  assert.equal(toTraces({}).size, 0);
});
