import assert from "node:assert/strict";
import { test } from "node:test";
import {
  toAge,
  toCount,
  toDegrees,
  toFixed,
  toMetres,
  toOrdinal,
  toShortMetres,
} from "../../robowidgets/js/shared/format.ts";

test("a minus is a real minus, and zero has none", () => {
  assert.equal(toFixed(-1.5, 2), "\u22121.50");
  for (const value of [0, -0, -0.004, -1e-12]) assert.equal(toFixed(value, 2), "0.00");
  assert.equal(toFixed(-0.006, 2), "\u22120.01");
});

test("ordinal numbers have English endings", () => {
  assert.deepEqual([1, 2, 3, 11, 22, 97].map(toOrdinal), ["1st", "2nd", "3rd", "11th", "22nd", "97th"]);
});

test("decimals are fixed, so that numbers stand in columns", () => {
  assert.deepEqual(
    [1, 10.5, 2.345].map((value) => toFixed(value, 2)),
    ["1.00", "10.50", "2.35"],
  );
  assert.equal(toFixed(3, 0), "3");
});

test("a number that is not finite is shown as a word", () => {
  assert.equal(toFixed(Number.NaN, 2), "NaN");
  assert.equal(toFixed(Infinity, 2), "+inf");
  assert.equal(toFixed(-Infinity, 2), "\u2212inf");
});

test("metres have a long and a short form", () => {
  assert.equal(toMetres(2.5), "2.50 m");
  const short = [6, 4.5, 100, 0.05, 0.125, 1.0004, 10.1, 0].map(toShortMetres);
  assert.deepEqual(short, ["6 m", "4.5 m", "100 m", "0.05 m", "0.125 m", "1 m", "10.1 m", "0 m"]);
});

test("metres have the decimals of the picture, and a distance never reads as 0", () => {
  assert.deepEqual(
    [0.003, 0.0025, 0].map((value) => toMetres(value, 0.004)),
    ["0.0030 m", "0.0025 m", "0.0000 m"],
  );
  assert.deepEqual(
    [0.003, 0.02, 0].map((value) => toMetres(value, 10)),
    ["0.003 m", "0.02 m", "0.00 m"],
  );
  assert.deepEqual([0.002, 0.000125, 0.0033333].map(toShortMetres), ["0.002 m", "0.000125 m", "0.00333 m"]);
});

test("from 1 km on metres are kilometres", () => {
  assert.deepEqual(
    [999.99, 1000, 1234.56].map((value) => toMetres(value, 5000)),
    ["999.99 m", "1.000 km", "1.235 km"],
  );
  assert.deepEqual([1000, 1200, 100_000].map(toShortMetres), ["1 km", "1.2 km", "100 km"]);
});

test("angles lie within half a turn, with one decimal", () => {
  const degrees = [0, 28.75, -28.75, 90, 180, -180, 270, -270, 359.9, 360, 541, -0.04].map((d) =>
    toDegrees((d * Math.PI) / 180),
  );
  const minus = "\u2212";
  assert.deepEqual(degrees, [
    "0.0°",
    "28.8°",
    `${minus}28.8°`,
    "90.0°",
    "180.0°",
    `${minus}180.0°`,
    `${minus}90.0°`,
    "90.0°",
    `${minus}0.1°`,
    "0.0°",
    `${minus}179.0°`,
    "0.0°",
  ]);
});

test("rounding errors of float32 are hidden", () => {
  assert.equal(toDegrees(Math.fround(Math.PI)), "180.0°");
  const angleMin = Math.fround((-130 * Math.PI) / 180);
  const angleIncrement = Math.fround((0.25 * Math.PI) / 180);
  assert.equal(toDegrees(angleMin + 635 * angleIncrement), "28.8°", "the paper's Figure 3");
});

test("large counts come in groups of three", () => {
  const space = "\u202f";
  const counts = [0, 12, 999, 1040, 12480, 1000000].map(toCount);
  assert.deepEqual(counts, ["0", "12", "999", `1${space}040`, `12${space}480`, `1${space}000${space}000`]);
});

test("an age is shown in tenths of a second, then in minutes and hours", () => {
  assert.deepEqual(
    [0, 2345, 59_940, 60_000, 200_000, 3_599_000, 7_300_000].map((ms) => toAge(ms)),
    ["0.0 s", "2.3 s", "59.9 s", "1 min", "3 min", "59 min", "2 h"],
  );
  assert.equal(toAge(2430, 2), "2.43 s");
});
