import assert from "node:assert/strict";
import { createRequire } from "node:module";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import { ticks } from "../../robowidgets/js/shared/ticks.ts";

const require = createRequire(new URL("../../robowidgets/js/package.json", import.meta.url));
const d3 = await import(pathToFileURL(require.resolve("d3-array")).href);

test("round numbers are the same as in d3-array", () => {
  const spans = [
    [0, 1],
    [0, 1039],
    [0, 5.6],
    [-1, 1],
    [0.3, 0.9],
    [-250, 30],
    [0, 0.002],
  ];
  for (const [from = 0, to = 0] of spans) {
    for (const count of [1, 2, 3, 4, 5, 8, 13, 20]) {
      assert.deepEqual(ticks(from, to, count), d3.ticks(from, to, count), `${from} to ${to}, ${count}`);
    }
  }
  assert.deepEqual(ticks(3, 3, 5), []);
});
