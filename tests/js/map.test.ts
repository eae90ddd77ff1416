import assert from "node:assert/strict";
import { test } from "node:test";
import { toCsv } from "../../robowidgets/js/export/csv.ts";
import { boundsOfLook, canZoom, lookOf, zoomed } from "../../robowidgets/js/path/camera.ts";
import {
  type Cells,
  cellAt,
  cellValue,
  cornersOf,
  distanceTo,
  ellipseOf,
  type LayerAbout,
  type LayerState,
  lengthOf,
  robotOf,
  wordOf,
} from "../../robowidgets/js/path/layers.ts";
import { frameOf } from "./vectors.ts";

const CELLS: Cells = { rows: 2, columns: 3, size: 0.5, step: 1, data: Uint8Array.of(0, 100, 255, 50, 255, 255) };

function state(number: number, x = 0, scatter: LayerState["scatter"] = [NaN, NaN, NaN]): LayerState {
  return { number, time: 0, x, y: 0, yaw: 0, scatter, points: [], total: 0, version: 0, cells: null };
}

function statesOf(...states: LayerState[]): Map<number, LayerState> {
  return new Map(states.map((one) => [one.number, one]));
}

test("the page of a map saves the poses of its layers, each with the time of its message", () => {
  const layers: LayerAbout[] = [
    { number: 0, name: "/amcl", kind: "pose" },
    { number: 1, name: "/poses", kind: "poses" },
    { number: 3, name: "/other", kind: "pose" },
  ];
  const [head, row] = toCsv("path_widget", [{ time: 2, about: 0, bytes: frameOf("map") }], layers).split("\n");
  const [amcl, other] = ["/amcl", "/other"].map((name) =>
    ["seconds", "x", "y", "yaw"].map((part) => `${name} ${part}`),
  );
  assert.deepEqual(head?.split(","), ["seconds", "stamp_ns", ...(amcl ?? []), ...(other ?? [])]);
  assert.deepEqual(row?.split(",").slice(2), ["0.5", "1.5", "-2", String(Math.PI), "", "", "", ""]);
});

test("a place is in the cell whose row and column a program finds, also on a grid that is turned", () => {
  const corner = { x: 1, y: 2, yaw: 0 };
  assert.deepEqual(cellAt(CELLS, corner, { x: 2.4, y: 2.6 }), [1, 2]);
  assert.equal(cellAt(CELLS, corner, { x: 0.9, y: 2.1 }), null);
  assert.equal(cellAt(CELLS, corner, { x: 1.1, y: 3.1 }), null);
  assert.deepEqual(cellAt(CELLS, { ...corner, yaw: Math.PI / 2 }, { x: 0.4, y: 3.2 }), [1, 2]);
});

test("values are the same as in messages, and have words", () => {
  assert.deepEqual(
    [0, 1, 2].map((column) => cellValue(CELLS, 0, column, 100)),
    [0, 100, -1],
  );
  assert.deepEqual(
    [0, 50, 100, -1, -2, 101].map((value) => wordOf(value, 100)),
    [...["free", "in between", "occupied", "unknown", "no such value", "no such value"]],
  );
  assert.equal(cellValue({ ...CELLS, data: Uint8Array.of(254) }, 0, 0, 254), 254);
  assert.deepEqual(
    [0, 100, 254, -1].map((value) => wordOf(value, 254)),
    ["free", "near something", "too close", "unknown"],
  );
});

test("the corners of a grid enclose its known cells", () => {
  const places = cornersOf(CELLS, { x: 1, y: 2, yaw: 0 });
  assert.deepEqual(places, [
    { x: 1, y: 2 },
    { x: 2, y: 2 },
    { x: 1, y: 3 },
    { x: 2, y: 3 },
  ]);
  assert.deepEqual(cornersOf({ ...CELLS, data: new Uint8Array(6).fill(255) }, { x: 0, y: 0, yaw: 0 }), []);
});

test("an ellipse holds 95 of 100 places, and lies along the less certain direction", () => {
  const round = ellipseOf([0.01, 0, 0.01]);
  assert.ok(round && Math.abs(round.long - 0.2448) < 1e-4 && Math.abs(round.short - 0.2448) < 1e-4);
  const along = ellipseOf([0.01, 0, 0.04]);
  assert.ok(along && Math.abs(along.yaw - Math.PI / 2) < 1e-9 && Math.abs(along.long - 2 * along.short) < 1e-9);
  assert.equal(ellipseOf([NaN, NaN, NaN]), null);
});

test("the distance from a line is measured to its nearest point, and its length is the sum of its parts", () => {
  const line = [
    { x: 0, y: 0 },
    { x: 4, y: 0 },
    { x: 4, y: 3 },
  ];
  assert.equal(distanceTo(line, { x: 2, y: 1.5 }), 1.5);
  assert.equal(distanceTo(line.slice(0, 1), { x: 3, y: 4 }), 5);
  assert.ok(Number.isNaN(distanceTo([], { x: 0, y: 0 })));
  assert.equal(lengthOf(line), 7);
});

test("the robot is the pose with a covariance, else the pose of tf, else the first pose", () => {
  const layer = (number: number, name: string, kind: LayerAbout["kind"] = "pose") => ({ number, name, kind });
  const layers = [layer(0, "/odom"), layer(1, "map->base_link"), layer(2, "/amcl_pose"), layer(3, "/goal", "goal")];
  const sure: LayerState["scatter"] = [0.1, 0, 0.1];
  assert.equal(robotOf(layers, statesOf(state(0, 1, sure), state(1), state(2, 1, sure)))?.number, 2);
  assert.equal(robotOf(layers, statesOf(state(0), state(1), state(3)))?.number, 1);
  assert.equal(robotOf(layers, statesOf(state(0), state(2, NaN, sure)))?.number, 0);
  assert.equal(robotOf(layers, statesOf(state(3))), undefined);
});

test("zooming keeps the place under the pointer, and ends if nothing more can be seen", () => {
  const look = { x: 0, y: 0, width: 10 };
  const at = { x: 4, y: 2 };
  const closer = zoomed(look, -1, at);
  assert.equal(closer.width, 8);
  assert.ok(Math.abs((at.x - closer.x) / closer.width - (at.x - look.x) / look.width) < 1e-12);
  const back = zoomed(closer, 1, at);
  assert.ok(Math.abs(back.x) < 1e-12 && back.width === 10);
  assert.equal(canZoom({ ...look, width: 0.2 }, -1), false);
  const bounds = boundsOfLook(look, { width: 424, height: 240 });
  assert.deepEqual(bounds, { west: -5, east: 5, south: -2.5, north: 2.5 });
  assert.deepEqual(lookOf(bounds), look);
});
