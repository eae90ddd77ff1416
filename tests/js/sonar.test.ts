import assert from "node:assert/strict";
import { test } from "node:test";
import { type Beam, toBeams } from "../../robowidgets/js/laser/sonar_layer.ts";
import { isWithin, overlaps } from "../../robowidgets/js/shared/box.ts";
import { distanceOf, nearestOf, type Ring, type Sonar, toMounts } from "../../robowidgets/js/shared/frames/ring.ts";
import { classify, READING, TOO_CLOSE } from "../../robowidgets/js/shared/frames/scan.ts";
import {
  type Cone,
  fitReadings,
  nextSilence,
  reachOf,
  resolveRange,
  toCones,
} from "../../robowidgets/js/sonar/cones.ts";
import { toFloorPoint, toPixel } from "../../robowidgets/js/sonar/floor.ts";
import { type Layout, type Level, LINE, layOut } from "../../robowidgets/js/sonar/labels.ts";
import { pick } from "../../robowidgets/js/sonar/pick.ts";
import { describeCone, shorten, toCode, toDistance } from "../../robowidgets/js/sonar/text.ts";
import { toNumber, vectors } from "./vectors.ts";

function sonarOf(range: number, changed: Partial<Sonar> = {}): Sonar {
  const [minRange, maxRange] = [changed.minRange ?? 0.1, changed.maxRange ?? 5];
  const kind = classify(range, minRange, Math.min(maxRange, 3e38));
  return { range, kind, minRange, maxRange, behind: 0, silentAfter: 10, fieldOfView: 0.5, pose: null, ...changed };
}

const SETTINGS = { poses: {}, near: null, fieldOfView: 0.26, elapsed: 0 };

function conesOf(sonars: Sonar[], changed: Partial<Parameters<typeof toCones>[2]> = {}): Cone[] {
  const names = sonars.map((_, i): [string, string, string] => [`sonar_${i}`, "ultrasound", ""]);
  const ring = { sequence: 1, rate: 10, arrived: 0, sonars };
  return toCones(ring, { sensors: names }, { ...SETTINGS, ...changed });
}

const FRONT = (90 * Math.PI) / 180;
const PIONEER = [90, 50, 30, 10, -10, -30, -50, -90, -90, -130, -150, -170, 170, 150, 130, 90];
/** The places of a Pioneer's ring: two sensors look to each side, 0.3 m apart. */
const POSES = Object.fromEntries(
  PIONEER.map((degrees, i): [string, [number, number, number]] => [
    `sonar_${i}`,
    [i < 8 ? 0.1 : -0.2, 0, (degrees * Math.PI) / 180],
  ]),
);

test("a range has the class and the distance that it has in Python", () => {
  for (const [range, minRange, maxRange, kind, distance] of vectors.ranges) {
    const sonar = sonarOf(toNumber(range), { minRange, maxRange: toNumber(maxRange) });
    assert.equal(sonar.kind, kind, `${range} within ${minRange} to ${maxRange}`);
    assert.deepEqual(distanceOf(sonar), toNumber(distance), `${range} within ${minRange} to ${maxRange}`);
  }
});

test("the nearest is too close before any reading, and missing if all are unknown or out of range", () => {
  assert.equal(nearestOf([2, 0.5, NaN].map((range) => sonarOf(range))), 1);
  assert.equal(nearestOf([2, 0.5, -Infinity].map((range) => sonarOf(range))), 2);
  assert.equal(nearestOf([Infinity, NaN, 0, 7].map((range) => sonarOf(range))), -1);
});

test("sensors without a place are spread evenly by their order, counter-clockwise from forward", () => {
  const mounts = toMounts(["a", "b", "toString", "d"], { b: [0.1, 0.2, 3] });
  assert.deepEqual(
    mounts.map(({ yaw }) => yaw),
    [0, 3, Math.PI, 1.5 * Math.PI],
  );
  assert.deepEqual(
    mounts.map(({ isKnown }) => isKnown),
    [false, true, false, false],
  );
  const told = toMounts(["a", "b", "c"], { b: [0.1, 0.2, 3] }, [[1, 1, 1], [2, 2, 2], null]);
  assert.deepEqual(
    told.map(({ x, isKnown }) => [x, isKnown]),
    [
      [1, true],
      [0.1, true],
      [0, false],
    ],
  );
});

test("a distance below the limit is an alarm, and so is too close, but not an unknown one", () => {
  const near = conesOf(
    [0.39, 0.4, -Infinity, NaN, 0, Infinity].map((range) => sonarOf(range)),
    { near: 0.4 },
  ).map(({ isNear }) => isNear);
  assert.deepEqual(near, [true, false, true, false, false, false]);
  assert.equal(conesOf([sonarOf(0.2)])[0]?.isNear, false);
});

test("a sensor is silent after its own time, while others go on; without a rate only compared with others", () => {
  const sonars = [
    sonarOf(1, { behind: 0, silentAfter: 1 }),
    sonarOf(1, { behind: 1.5, silentAfter: 1 }),
    sonarOf(1, { behind: 3, silentAfter: 10 }),
    sonarOf(1, { behind: 11, silentAfter: 10 }),
    sonarOf(NaN, { behind: Infinity }),
  ];
  const silent = (elapsed: number) => conesOf(sonars, { elapsed }).map(({ isSilent }) => isSilent);
  assert.deepEqual(silent(0), [false, true, false, true, true]);
  assert.deepEqual(silent(1.1), [true, true, false, true, true]);
  assert.deepEqual(silent(100), [true, true, false, true, true]);
  assert.equal(nextSilence(conesOf(sonars, { elapsed: 0.25 })), 0.75);
  assert.equal(nextSilence(conesOf(sonars, { elapsed: 2 })), Infinity);
  assert.equal(conesOf(sonars)[4]?.hasCome, false);
});

test("the picture has the range of the sensors, or without one fits their readings so far", () => {
  const limited = conesOf([sonarOf(1), sonarOf(2, { maxRange: 3 })], { poses: { sonar_0: [0.3, 0.4, 0] } });
  assert.equal(reachOf(limited), 5.5);
  assert.equal(resolveRange(null, limited, 9), 5.5);
  assert.equal(resolveRange(2, limited, 9), 2);
  const free = conesOf([sonarOf(1.2, { maxRange: Infinity }), sonarOf(Infinity, { maxRange: Infinity })]);
  assert.equal(fitReadings(free), 1.5);
  assert.equal(resolveRange(null, free, 0), 1.5);
  assert.equal(resolveRange(null, free, 4), 4);
  assert.equal(resolveRange(null, [], 0), 2);
});

test("forward is up and left is left", () => {
  const view = { centerX: 100, centerY: 200, radius: 50, viewRange: 5 };
  assert.deepEqual(toPixel(view, { x: 1, y: 0 }), { x: 100, y: 190 });
  assert.deepEqual(toPixel(view, { x: 0, y: 1 }), { x: 90, y: 200 });
  const beside = toFloorPoint({ x: 1, y: 2, yaw: FRONT, isKnown: true }, 3, 0);
  assert.ok(Math.abs(beside.x - 1) < 1e-9 && Math.abs(beside.y - 5) < 1e-9);
});

/** Characters of 7 pixels, as wide as the longest line. */
function halfOf({ name }: Cone, level: Level): { width: number; height: number } {
  const lines = [level < 2 ? 5 : 8, ...(level >= 2 ? [name.length + 5] : level ? [4] : []), ...(level > 2 ? [5] : [])];
  return { width: (7 * Math.max(...lines)) / 2, height: (LINE * lines.length) / 2 };
}

function layoutOf(cones: Cone[], width: number, height = 0.9 * width): Layout {
  return layOut(cones, { x: 0, y: 0, width, height }, resolveRange(null, cones, 0), halfOf);
}

test("labels never overlap and stay in the picture, at any width; wide pictures say more than narrow ones", () => {
  const rings = {
    pioneer: conesOf(
      PIONEER.map(() => sonarOf(1)),
      { poses: POSES },
    ),
    few: conesOf([1, 2, 3].map((range) => sonarOf(range))),
    many: conesOf(Array.from({ length: 24 }, () => sonarOf(1))),
  };
  for (const [name, cones] of Object.entries(rings)) {
    const levels = [300, 320, 480, 760].map((width) => {
      const { labels, level, view } = layoutOf(cones, width);
      assert.equal(labels.length, cones.length, `${name} at ${width}`);
      const picture = { x: 0, y: 0, width, height: 0.9 * width };
      for (const [i, { box }] of labels.entries()) {
        assert.ok(isWithin(box, picture), `${name} at ${width}: label ${i} leaves the picture`);
        for (const other of labels.slice(i + 1)) assert.ok(!overlaps(box, other.box), `${name} at ${width}: ${i}`);
      }
      assert.ok(view.radius > 0.22 * width, `${name} at ${width}: the picture has a radius of ${view.radius}`);
      return level;
    });
    assert.deepEqual(levels, [...levels].sort());
  }
  assert.equal(layoutOf(rings.few, 480).level, 3);
  assert.equal(layoutOf(rings.pioneer, 760).level, 3);
});

test("if even numbers have no room some labels are left out, but never the label of an alarm", () => {
  const sonars = Array.from({ length: 100 }, (_, i) => sonarOf(i === 57 ? 0.2 : 1));
  const cones = conesOf(sonars, { near: 0.3 });
  const { labels, level } = layoutOf(cones, 300);
  assert.equal(level, 0);
  assert.ok(labels.length < 100 && labels.length > 15, `${labels.length}`);
  assert.ok(labels.some(({ index }) => index === 57));
  for (const [i, { box }] of labels.entries())
    for (const other of labels.slice(i + 1)) assert.ok(!overlaps(box, other.box));
});

test("a point names the cone in which it lies, the closer axis of two, and a label its sensor", () => {
  const cones = conesOf(
    PIONEER.map(() => sonarOf(2)),
    { poses: POSES },
  );
  const { view, labels } = layoutOf(cones, 600);
  for (const cone of cones) {
    const at = toPixel(view, toFloorPoint(cone.mount, 3, 0));
    assert.equal(pick(view, cones, labels, at), cone.index, `sensor ${cone.index}`);
  }
  for (const { index, box } of labels) {
    assert.equal(pick(view, cones, labels, { x: box.x + 1, y: box.y + 1 }), index);
  }
  assert.equal(pick(view, cones, labels, { x: view.centerX, y: view.centerY }), null);
  assert.equal(pick(view, cones, [], { x: view.centerX, y: view.centerY - view.radius - 20 }), null);
  const apart = conesOf([sonarOf(1), sonarOf(1)]);
  assert.equal(pick(view, apart, [], { x: view.centerX + 50, y: view.centerY }), null);
});

test("a missing distance is never shown as one", () => {
  const said = (range: number, changed: Partial<Sonar> = {}) => {
    const [cone] = conesOf([sonarOf(range, changed)], { near: 0.3 });
    return [false, true].map((isShort) => toDistance(cone as Cone, 5, isShort));
  };
  assert.deepEqual(said(1.234), ["1.23 m", "1.23"]);
  assert.deepEqual(said(0.21), ["\u25B2 0.21 m", "0.21!"]);
  assert.deepEqual(said(-Infinity), ["\u25B2 too close", "\u2212inf"]);
  assert.deepEqual(said(Infinity), ["nothing", "+inf"]);
  assert.deepEqual(said(NaN), ["unknown", "NaN"]);
  assert.deepEqual(said(7), ["outside", "7.00?"]);
  assert.deepEqual(said(1, { behind: 12 }), ["silent 12 s", "\u2013"]);
  assert.deepEqual(said(NaN, { behind: Infinity }), ["no data yet", "\u2013"]);
});

test("the pop-up describes a sensor in words", () => {
  const [cone] = conesOf([sonarOf(0.2)], { near: 0.3, poses: { sonar_0: [0.1, -0.05, -0.5] }, elapsed: 0.25 });
  const { expression, distance, angle, side, details } = describeCone(cone as Cone, 0.3, 5);
  assert.deepEqual([expression, distance, angle, side], ["[0] sonar_0", "0.20 m", "\u221228.6\u00B0", "right"]);
  assert.equal(
    details,
    "\u25B2 nearer than 0.3 m\nbeam 28.6\u00B0, 0.1 m to 5 m\nultrasound, x\u00A00.10  y\u00A0\u22120.05\n0.25 s old",
  );
  const [nothing] = conesOf([sonarOf(Infinity, { fieldOfView: 0, minRange: 0, maxRange: Infinity })]);
  assert.equal(
    describeCone(nothing as Cone, null, 5).details,
    "+inf: nothing in range\nbeam 14.9\u00B0 (not given), no limits given\nultrasound, place not known\n0.00 s old",
  );
  assert.equal(nothing?.sonar.kind === READING || nothing?.sonar.kind === TOO_CLOSE, false);
});

test("code has the name as Python reads it, and labels have room for a long one", () => {
  assert.equal(toCode("front_3"), 'sonars["front_3"].distance');
  assert.equal(toCode('a"\\b'), 'sonars["a\\"\\\\b"].distance');
  assert.equal(shorten("front_3"), "front_3");
  assert.equal(shorten("the_very_long_name_3"), "the_ve\u2026_name_3");
});

test("a laser shows the beams whose place is known, at their places for its scanner", () => {
  const names: [string, string, string][] = [
    ["front", "ultrasound", ""],
    ["ir", "infrared", ""],
    ["lost", "ultrasound", ""],
    ["silent", "ultrasound", ""],
    ["near", "ultrasound", ""],
    ["nearer", "ultrasound", ""],
  ];
  const sonars = [
    sonarOf(2, { pose: [0.3, 0.1, 0] }),
    sonarOf(Infinity, { pose: [0.2, 0, Math.PI / 2], fieldOfView: 0 }),
    sonarOf(1),
    sonarOf(1, { pose: [0, 0, 0], behind: 20 }),
    sonarOf(-Infinity, { pose: [0, 0, 0], minRange: 0.3 }),
    sonarOf(0.1, { pose: [0, 0, 0], minRange: 0.3 }),
  ];
  // The scanner stands 0.2 m ahead of the middle of the robot, and looks to its left.
  const scanner: [number, number, number] = [0.2, 0, Math.PI / 2];
  const ring = { sequence: 1, rate: 10, stamp: 0, arrived: 0, sonars };
  const beams = toBeams(ring as unknown as Ring, { sensors: names }, {}, 0.26, scanner);
  assert.deepEqual(
    beams.map(({ name, isReading, isTooClose }) => [name, isReading, isTooClose]),
    [
      ["front", true, false],
      ["ir", false, false],
      ["near", false, true],
      ["nearer", false, true],
    ],
  );
  assert.deepEqual(
    beams.slice(2).map(({ reach }) => reach),
    [0.3, 0.3],
  );
  const [front, ir] = beams as [Beam, Beam];
  assert.ok(Math.hypot(front.x - 0.1, front.y + 0.1) < 1e-9);
  assert.ok(Math.abs(front.yaw + Math.PI / 2) < 1e-9 && front.reach === 2 && front.view === 0.5);
  assert.ok(Math.abs(ir.yaw) < 1e-9 && ir.reach === 5);
  assert.ok(Math.abs(ir.view - Math.PI / 60) < 1e-9, "an infrared beam is thin");
});
