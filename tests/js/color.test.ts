import assert from "node:assert/strict";
import { createRequire } from "node:module";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import { colorScale, intensityDomain } from "../../robowidgets/js/laser/color.ts";
import { VIRIDIS } from "../../robowidgets/js/shared/viridis.ts";
import { scanOf } from "./laser.ts";

const require = createRequire(new URL("../../robowidgets/js/package.json", import.meta.url));
const chromatic = await import(pathToFileURL(require.resolve("d3-scale-chromatic")).href);
const interpolateViridis: (t: number) => string = chromatic.interpolateViridis;

const lit = (ranges: number[], intensities: number[]) =>
  scanOf(ranges, { intensities: Float32Array.from(intensities) });

test("viridis is d3's, in 64 even steps", () => {
  assert.equal(VIRIDIS.length, 64);
  for (const [i, color] of VIRIDIS.entries()) assert.equal(color, interpolateViridis(i / 63), `step ${i}`);
});

test("the scale spans the intensities of the readings alone", () => {
  const scan = lit([1, Infinity, 2, 3, 0, 4], [10, 900, 20, Number.NaN, -5, Infinity]);
  assert.deepEqual(intensityDomain(scan, null), [10, 20]);
});

test("without a reading that has an intensity the scale is missing", () => {
  assert.equal(intensityDomain(scanOf([1, 2]), null), null);
  assert.equal(intensityDomain(lit([Infinity, 0], [1, 2]), [1, 2]), null);
  assert.equal(intensityDomain(lit([1], [Number.NaN]), null), null);
});

test("the scale widens at once, and narrows only when far too wide", () => {
  assert.deepEqual(intensityDomain(lit([1, 1], [0, 30]), [10, 20]), [0, 30]);
  assert.deepEqual(intensityDomain(lit([1, 1], [5, 25]), [0, 30]), [0, 30]);
  assert.deepEqual(intensityDomain(lit([1, 1], [10, 24]), [0, 30]), [10, 24]);
});

test("colours run from one end to the other, and values outside get the colour of an end", () => {
  for (const dark of [false, true]) {
    const colorOf = colorScale([10, 20], dark);
    const shown = dark ? VIRIDIS.slice(16) : VIRIDIS.slice(0, 54);
    assert.equal(colorOf(10), shown[0]);
    assert.equal(colorOf(20), shown.at(-1));
    assert.equal(colorOf(15), shown[shown.length / 2]);
    assert.equal(colorOf(-99), shown[0]);
    assert.equal(colorOf(99), shown.at(-1));
    assert.equal(colorOf(Number.NaN), "gray");
  }
});

test("equal intensities have a colour", () => {
  assert.equal(colorScale([5, 5], false)(5), VIRIDIS[0]);
});
