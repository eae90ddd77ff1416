import assert from "node:assert/strict";
import { test } from "node:test";
import {
  type Cloud,
  type Column,
  countOf,
  indexOf,
  nearestOf,
  placeOf,
  selectedIn,
} from "../../robowidgets/js/cloud/cloud.ts";
import { colorsOf, domainOf, toPixel as toPixelColor } from "../../robowidgets/js/cloud/colors.ts";
import { AXES, fitTo, project, steadied, toMetres, toPixel, zoomed } from "../../robowidgets/js/cloud/projection.ts";
import {
  bandWords,
  countWords,
  describePoint,
  exact,
  FORMS,
  hasCode,
  rounded,
  thinnedWords,
  toCode,
} from "../../robowidgets/js/cloud/text.ts";
import { vectors } from "./vectors.ts";

const MINUS = "\u2212";

function cloudOf(points: [number, number, number][], more: Partial<Cloud> = {}, others: Record<string, Column> = {}) {
  const [x, y, z] = [0, 1, 2].map((axis) => Float32Array.from(points, (point) => point[axis as 0])) as [
    Float32Array,
    Float32Array,
    Float32Array,
  ];
  const fields = new Map(
    Object.entries({ x, y, z, ...others }).map(([name, values]) => [name, { name, type: "f4", size: 1, values }]),
  );
  const distance = Float32Array.from(points, (point) => Math.hypot(...point));
  const facts = { total: points.length, rows: 1, columns: points.length, unmeasured: 0, step: 1, count: points.length };
  return { sequence: 1, rate: NaN, arrived: 0, ...facts, fields, x, y, z, distance, ...more } as Cloud;
}

test("x is up in the picture and y to the left from above, and each view looks as REP-103 has it", () => {
  const box = { x: 0, y: 0, width: 200, height: 200 };
  const look = { right: 0, up: 0, range: 10 };
  const seen = (view: keyof typeof AXES, point: { x: number; y: number; z: number }) => {
    const { right, up } = AXES[view];
    return toPixel(project(AXES[view], box, look), right.sign * point[right.name], up.sign * point[up.name]);
  };
  assert.deepEqual(seen("above", { x: 5, y: 0, z: 9 }), { x: 100, y: 50 });
  assert.deepEqual(seen("above", { x: 0, y: 5, z: 9 }), { x: 50, y: 100 });
  assert.deepEqual(seen("side", { x: 5, y: 9, z: 2 }), { x: 150, y: 80 });
  assert.deepEqual(seen("behind", { x: 9, y: 5, z: 2 }), { x: 50, y: 80 });
});

test("a zoom keeps the place under the pointer", () => {
  const box = { x: 10, y: 20, width: 300, height: 200 };
  const before = project(AXES.above, box, { right: 1, up: 2, range: 10 });
  const at = { x: 77, y: 133 };
  const after = project(AXES.above, box, zoomed(before.look, -1, toMetres(before, at)));
  const [right, up] = toMetres(before, at);
  const { x, y } = toPixel(after, right, up);
  assert.ok(Math.abs(x - at.x) < 1e-9 && Math.abs(y - at.y) < 1e-9);
  assert.ok(after.scale > before.scale);
});

test("all points and the sensor are in the picture, which stands still while they move a little", () => {
  const box = { x: 0, y: 0, width: 300, height: 200 };
  const cloud = cloudOf([
    [8, 1, 0],
    [2, -3, 0],
    [NaN, NaN, NaN],
  ]);
  const look = fitTo(cloud, AXES.above, box);
  const projection = project(AXES.above, box, look);
  for (const [x, y] of [
    [8, 1],
    [2, -3],
    [0, 0],
  ] as const) {
    const at = toPixel(projection, -y, x);
    assert.ok(at.x > 0 && at.x < 300 && at.y > 0 && at.y < 200);
  }
  const first = steadied(null, look);
  assert.equal(steadied(first, { ...look, range: look.range * 0.95 }), first);
  assert.notEqual(steadied(first, { ...look, range: look.range * 1.5 }), first);
  assert.notEqual(steadied(first, { ...look, range: look.range / 4 }), first);
});

test("bounds are compared as NumPy compares a float32, and leave out points that were not measured", () => {
  const cloud = cloudOf(
    [
      [0.7, 0, 0],
      [0.71, 0, 0],
      [NaN, 0, 0],
    ],
    {},
    { ring: Uint16Array.of(1, 2, 3) },
  );
  assert.equal(selectedIn(cloud, {}), null);
  const within = (selection: Record<string, [number, number]>) => [...(selectedIn(cloud, selection) as Uint8Array)];
  // float32(0.7) is less than 0.7.
  assert.deepEqual(within({ x: [0.7, 0.7] }), [1, 0, 0]);
  assert.deepEqual(within({ ring: [2, 9] }), [0, 1, 0]);
  assert.deepEqual(within({ other: [0, 1] }), [0, 0, 0]);
  assert.deepEqual(within({ distance: [0.705, 1], ring: [0, 9] }), [0, 1, 0]);
  assert.equal(countOf(Uint8Array.of(1, 0, 1)), 2);
  assert.equal(nearestOf(cloud, null), 0);
  assert.equal(nearestOf(cloud, Uint8Array.of(0, 1, 1)), 1);
});

test("indices of thinned clouds are indices of the whole, by points or by rows and columns", () => {
  const thinned = cloudOf(
    [
      [1, 0, 0],
      [2, 0, 0],
    ],
    { total: 9, step: 5 },
  );
  assert.deepEqual([indexOf(thinned, 0), indexOf(thinned, 1)], [0, 5]);
  assert.equal(thinnedWords(thinned), "every 5th of 9 points drawn");
  const rows = cloudOf(
    [
      [1, 0, 0],
      [2, 0, 0],
      [3, 0, 0],
      [4, 0, 0],
    ],
    { total: 12, rows: 4, columns: 3, step: 2 },
  );
  assert.deepEqual(
    [0, 1, 2, 3].map((i) => indexOf(rows, i)),
    [0, 2, 6, 8],
  );
  assert.deepEqual(placeOf(rows, 3), [2, 2]);
  assert.equal(thinnedWords({ ...rows, step: 23 }), "every 23rd row and column of 12 points drawn");
  assert.equal(thinnedWords({ ...rows, step: 1 }), "");
  assert.equal(countWords(thinned, 1, null), "1 of 2 drawn points");
  assert.equal(countWords(thinned, 1, 4), "4 of 9 points");
});

test("the pop-up of a point has every field, exactly as it was sent", () => {
  const lit = Float32Array.of(0, 47.1);
  const rgb = new Float32Array(Uint32Array.of(0, 0x00ff8001).buffer);
  const cloud = cloudOf(
    [
      [0, 0, 0],
      [3, -4, 0],
    ],
    {},
    { intensity: lit, rgb, ring: Uint16Array.of(0, 7) },
  );
  assert.deepEqual(describePoint(cloud, 1), {
    expression: "points[1]",
    distance: "5.00 m",
    angle: "",
    details: `x\u00a03.000  y\u00a0${MINUS}4.000  z\u00a00.000\nintensity 47.1\nrgb 255, 128, 1\nring 7`,
    side: "",
  });
  assert.equal(describePoint({ ...cloud, total: 4, rows: 2, columns: 2 }, 1).side, "row 0, column 1");
  assert.equal(exact(Math.fround(0.1), Float32Array.of(0)), "0.1");
  assert.equal(exact(0.30000000000000004, Float64Array.of(0)), "0.30000000000000004");
  assert.equal(exact(NaN, Float32Array.of(0)), "NaN");
});

test("code is the same as Python's, in each form that has the fields", () => {
  for (const [bands, codes] of vectors.selections) {
    for (const form of FORMS)
      assert.equal(hasCode(bands, form) ? toCode(bands, form) : null, codes[form], JSON.stringify(bands));
  }
});

test("bounds are rounded to short numbers, and shown with their units", () => {
  assert.deepEqual(rounded([0.123456, 0.987654], 5), [0.12, 0.99]);
  assert.deepEqual(rounded([0.123456, 0.987654], 500), [0, 1]);
  assert.equal(bandWords({ z: [-0.5, 1], ring: [1, 2] }), `z ${MINUS}0.5 to 1 m\nring 1 to 2`);
});

test("colours span the measured values, hold for a while, and are the field's own if it has some", () => {
  const cloud = cloudOf([
    [1, 0, 0],
    [2, 0, 4],
    [NaN, 0, 99],
  ]);
  assert.deepEqual(domainOf(cloud, "z", null), [0, 4]);
  assert.deepEqual(domainOf(cloud, "z", [-1, 5]), [-1, 5]);
  assert.deepEqual(domainOf(cloud, "z", [-100, 5]), [0, 4]);
  assert.equal(domainOf(cloud, "other", null), null);
  const { pixels } = colorsOf(cloud, "z", [0, 4], false, 1, 2);
  assert.equal(pixels[0], toPixelColor("#440154"));
  assert.notEqual(pixels[1], pixels[0]);
  assert.deepEqual([...colorsOf(cloud, "", null, false, 1, 2).pixels], [1, 1, 1]);
  const colored = cloudOf([[1, 0, 0]], {}, { rgb: new Float32Array(Uint32Array.of(0x00ff8001).buffer) });
  assert.deepEqual([...colorsOf(colored, "rgb", null, false, 1, 2).pixels], [0xff0180ff]);
  assert.equal(toPixelColor("rgb(255, 128, 1)"), 0xff0180ff);
});
