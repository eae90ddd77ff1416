import assert from "node:assert/strict";
import { test } from "node:test";
import type { Host, Stage } from "../../robowidgets/js/laser/layer.ts";
import { ShapeLayer } from "../../robowidgets/js/laser/shape_layer.ts";
import { describeShape, lasting, readingOf, toPicture, untilNext } from "../../robowidgets/js/laser/shapes.ts";
import type { Box, Point } from "../../robowidgets/js/shared/box.ts";
import { overlaps } from "../../robowidgets/js/shared/box.ts";
import type { Scan } from "../../robowidgets/js/shared/frames/scan.ts";
import { Occupancy } from "../../robowidgets/js/shared/occupancy.ts";
import { pathOf } from "../../robowidgets/js/shared/shapes/draw.ts";
import { boxAt, PLACES } from "../../robowidgets/js/shared/shapes/labels.ts";
import { arcPlaces, isCircle, type Metres, placesOf } from "../../robowidgets/js/shared/shapes/places.ts";
import type { Theme } from "../../robowidgets/js/shared/theme.ts";
import type { Shape } from "../../robowidgets/js/shared/traits.ts";
import { DEGREE, near, scanOf } from "./laser.ts";

const shape = (kind: Shape["kind"], more: Partial<Shape> = {}): Shape => ({ name: "x", kind, at: [], ...more });
const NEAR = (a: Metres, b: Metres) => near(a[0], b[0], 1e-6) && near(a[1], b[1], 1e-6);

test("the index of a ray stands for its reading in the scan on show, and for nothing without one", () => {
  const scan = scanOf([2, Number.NaN, 4], { angleMin: -90 * DEGREE, angleIncrement: 90 * DEGREE });
  const of = (shown: Scan | null) => (index: number) => readingOf(shown, index);
  const places = placesOf([[1, 0.5], 0, 2], of(scan)) as Metres[];
  assert.deepEqual(places[0], [1, 0.5]);
  assert.ok(NEAR(places[1] as Metres, [0, -2]) && NEAR(places[2] as Metres, [0, 4]));
  assert.equal(placesOf([0, 1], of(scan)), null, "no reading");
  assert.equal(placesOf([3], of(scan)), null, "no such ray");
  assert.equal(placesOf([0], of(null)), null, "no scan");
});

test("an arc runs counter-clockwise from its first angle to its second, across the seam too", () => {
  const ends = (start: number, end: number) => {
    const places = arcPlaces(shape("arc", { radius: 2, start: start * DEGREE, end: end * DEGREE }), [1, 0]);
    return [places[0], places[Math.floor(places.length / 2)], places.at(-1)] as [Metres, Metres, Metres];
  };
  const [first, middle, last] = ends(-90, 90);
  assert.ok(NEAR(first, [1, -2]) && NEAR(middle, [3, 0]) && NEAR(last, [1, 2]));
  assert.ok(NEAR(ends(90, -90)[1], [-1, 0]));
  assert.ok(isCircle(shape("arc", { start: 0, end: 2 * Math.PI })) && !isCircle(shape("arc", { start: 0, end: 3 })));
});

test("places and directions of shapes are in the frame of the angle on show", () => {
  const told = (kind: Shape["kind"], places: Metres[], toShown: (angle: number) => number, more: Partial<Shape> = {}) =>
    describeShape(shape(kind, more), places, 10, "deg", toShown);
  const turned = (angle: number) => angle - 90 * DEGREE;
  const upsideDown = (angle: number) => 270 * DEGREE - angle;
  const [place, yaw]: [Metres[], number] = [[[2, 0.5]], 30 * DEGREE];
  assert.equal(told("arrow", place, turned, { yaw }), "x\u00A00.50 y\u00A0\u22122.00 \u00B7 \u221260.0°");
  assert.equal(told("arrow", place, upsideDown, { yaw }), "x\u00A0\u22120.50 y\u00A0\u22122.00 \u00B7 \u2212120.0°");
  const line: Metres[] = [
    [1, 0],
    [2, 1],
  ];
  assert.ok(told("line", line, turned).endsWith(" \u221245.0°"));
  assert.ok(told("line", line, upsideDown).endsWith(" 45.0°"));
});

test("the numbers of a shape stand below its name", () => {
  const told = (kind: Shape["kind"], places: Metres[], more: Partial<Shape> = {}) =>
    describeShape(shape(kind, more), places, 10);
  const wall: Metres[] = [
    [2, -1],
    [-1, -1],
  ];
  assert.equal(told("line", wall), "1.00 m \u00B7 0.0°", "the closest point lies within, and a wall has no direction");
  assert.equal(told("line", [wall[0] as Metres, [3, 0]]), "2.24 m \u00B7 45.0°", "the closest point is an end");
  assert.equal(
    told("line", [
      [1, -1],
      [1, 0],
      [1, 1],
    ]),
    "",
    "of three places",
  );
  assert.equal(told("points", [[3, 4]]), "5.00 m");
  assert.equal(told("points", wall), "2 points");
  assert.equal(told("arc", [[0, 0]], { radius: 0.5 }), "0.50 m");
  assert.equal(told("arrow", [[2, 0.5]], { yaw: 30 * DEGREE }), "x\u00A02.00 y\u00A00.50 \u00B7 30.0°");
  assert.equal(told("polygon", wall) + told("text", wall), "");
});

test("a shape disappears at once when its time is over", () => {
  const shapes = [shape("line", { left: 0.5 }), shape("text"), shape("arc", { left: 2 })];
  assert.equal(lasting(shapes, 499).length, 3);
  assert.deepEqual(lasting(shapes, 501), shapes.slice(1));
  assert.equal(untilNext(shapes, 100), 400);
  assert.equal(untilNext(shapes, 600), 1400);
  assert.equal(untilNext(shapes, 3000), Infinity);
});

test("words stand next to a shape and never on it", () => {
  const path = Array.from({ length: 30 }, (_, i) => ({ x: 100 + 4 * i, y: 200 }));
  const boxes = Array.from({ length: PLACES }, (_, place) => boxAt(path, 60, 30, place) as Box);
  const off = boxes.filter((box) => !path.some(({ x, y }) => overlaps(box, { x, y, width: 0, height: 0 })));
  assert.ok(off.length >= 0.7 * PLACES);
  assert.ok(new Set(boxes.map(({ x, y }) => `${x},${y}`)).size > 0.9 * PLACES);
  assert.equal(boxAt([], 60, 30, 0), null, "nothing of it is in view");
  const [middle] = path.slice(15) as [Point];
  assert.deepEqual(boxAt([middle], 60, 30, 0, true), { x: middle.x - 30, y: 185, width: 60, height: 30 }, "a text");
});

test("parts beyond the view are left out of the picture", () => {
  const projection = { centerX: 100, centerY: 100, radius: 100, viewRange: 4, forward: Math.PI / 2 };
  const toPoint = (place: Metres) => toPicture(projection, place);
  const isInView = ({ x, y }: Point) => Math.hypot(x - 100, y - 100) <= 100;
  const path = (...places: Metres[]) => pathOf(toPoint, isInView, shape("line"), places);
  assert.deepEqual(path([5, -1], [5, 1]), []);
  const across = path([2, -9], [2, 9]);
  assert.ok(across.length > 10 && across.every(({ x, y }) => Math.hypot(x - 100, y - 100) <= 100));
  assert.ok(across.every(({ y }) => near(y, 50)));
});

test("all shapes are clipped to the view at once: a clip takes longer than a shape", () => {
  const calls: string[] = [];
  const context = new Proxy({}, { get: (_, name) => () => calls.push(String(name)), set: () => true });
  const shapes = [1, 2, 3].map((x) => shape("line", { at: [[x, -9] as Metres, [x, 9] as Metres] }));
  const host = { signal: new AbortController().signal, stream: { about: { shapes }, paused: true } };
  const projection = { centerX: 100, centerY: 100, radius: 90, viewRange: 5, forward: 0 };
  const stage = { scan: null, projection, occupied: new Occupancy(200, 200) } as unknown as Stage;
  const painters = new ShapeLayer(host as unknown as Host).painters();
  painters.shapes?.(context as CanvasRenderingContext2D, stage, {} as Theme);
  const told = calls.filter((name) => /clip|stroke|restore/.test(name));
  assert.deepEqual(told, ["clip", "stroke", "stroke", "stroke", "restore"]);
});
