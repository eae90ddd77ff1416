import assert from "node:assert/strict";
import { test } from "node:test";
import { linesBehind, litRuns } from "../../robowidgets/js/laser/condition_layer.ts";
import { changeFrom, lampsOf, stateWords } from "../../robowidgets/js/shared/lamps.ts";
import type { Lamp } from "../../robowidgets/js/shared/traits.ts";
import { layOut, scanOf, sweepOf } from "./laser.ts";

const LIT: Lamp = { name: "wall", state: "true", text: "0.40 < 0.50 m", since: 9.5, changes: 1, rays: [2, 4, 7, 8] };
const OFF: Lamp = { ...LIT, state: "off", text: "switched off: line 2: ZeroDivisionError", rays: [] };

test("a lamp is lit only for the sample that was judged, and not when that is stale", () => {
  const about = { lamps: [LIT, OFF], judged: 5 };
  assert.deepEqual(lampsOf(about, 5), [LIT, OFF]);
  const unknown = [{ ...LIT, state: "unknown", text: "", rays: [] }, OFF];
  assert.deepEqual(lampsOf(about, 6), unknown);
  assert.deepEqual(lampsOf(about, 5, true), unknown);
  assert.deepEqual(lampsOf(about, undefined), unknown);
  assert.deepEqual(lampsOf({}, 5), []);
});

test("rays are marked only while their condition is lit", () => {
  const about = { lamps: [LIT, { ...LIT, state: "false" as const }], judged: 5 };
  assert.deepEqual(litRuns(lampsOf(about, 5)), [
    [2, 4],
    [7, 8],
  ]);
  assert.deepEqual(litRuns(lampsOf(about, 6)), []);
  assert.deepEqual(litRuns(lampsOf(about, 5, true)), [], "nor while nothing is known of the present");
});

test("stepping through changes goes in both directions, past unknown states", () => {
  const states = ["unknown", "false", "false", "true", "unknown", "true", "false", "false"];
  assert.equal(changeFrom(states, states.length, -1), 6);
  assert.equal(changeFrom(states, 6, -1), 3);
  assert.equal(changeFrom(states, 3, -1), -1);
  assert.equal(changeFrom(states, 0, 1), 3);
  assert.equal(changeFrom(states, 3, 1), 6);
  assert.equal(changeFrom([], 0, -1), -1);
});

test("the words have the duration of a state, by the clock of the sample", () => {
  assert.deepEqual(stateWords(LIT, 10.3), ["true", " for 0.8 s"]);
  assert.deepEqual(stateWords({ ...LIT, state: "unknown" }, 10.3), ["unknown", ""]);
  assert.deepEqual(stateWords(OFF, 10.3), ["off", ""]);
});

test("lines lie behind the readings, one for each thing", () => {
  const sweep = sweepOf(90, 9);
  const { projection } = layOut(sweep);
  const scan = scanOf([5, 5, 2, 2, 5, 5, 5, 2, 2], { ...sweep, sequence: 5 });
  const lines = linesBehind({ scan, projection }, [
    [2, 4],
    [7, 8],
  ]);
  assert.deepEqual(
    lines.map(({ length }) => length),
    [2, 2],
  );
  const away = ({ x, y }: { x: number; y: number }) => Math.hypot(x - projection.centerX, y - projection.centerY);
  const scale = projection.radius / projection.viewRange;
  for (const point of lines[0] ?? []) assert.ok(Math.abs(away(point) - (2 * scale + 5)) < 1e-6);
  const parts = linesBehind({ scan, projection }, [[0, 9]]).map(({ length }) => length);
  assert.ok(parts.length > 1, "things at other distances are not joined");
  assert.deepEqual(linesBehind({ scan, projection: { ...projection, viewRange: 1 } }, [[2, 4]]), []);
});
