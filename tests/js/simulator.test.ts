import assert from "node:assert/strict";
import { test } from "node:test";
import { fit, type Pose, toFloor, toPixel } from "../../robowidgets/js/shared/floor.ts";
import type { Theme } from "../../robowidgets/js/shared/theme.ts";
import { drawDrops } from "../../robowidgets/js/simulator/draw.ts";
import { drawShapes } from "../../robowidgets/js/simulator/draw_shapes.ts";
import { Edits } from "../../robowidgets/js/simulator/edits.ts";
import {
  boundsOf,
  draggedTo,
  endsOf,
  handleOf,
  movedBy,
  poseOf,
  type Scene,
  thingAt,
  toPlace,
  toScene,
  toWalls,
  withThing,
} from "../../robowidgets/js/simulator/scene.ts";
import type { RoomShape } from "../../robowidgets/js/simulator/traits.ts";
import { FakeModel } from "./models.ts";

const ROOM = new Float32Array([-2, -1, 2, -1, 2, -1, 2, 1]);

function scene(): Scene {
  return {
    time: 1,
    robot: { x: 0, y: 0, yaw: Math.PI / 2, radius: 0.2 },
    scan: {
      x: 0,
      y: 0,
      yaw: 0,
      angleMin: 0,
      angleIncrement: Math.PI / 2,
      rangeMax: 4,
      ranges: Float32Array.of(1, Infinity, NaN),
    },
    path: [],
    obstacles: [{ x: 1, y: 0.5, radius: 0.25 }],
  };
}

function frame(): DataView {
  const header = [1.5, 1, 2, 0.5, 0.2, 1, 2, 0.4, -1, 0.5, 6, 2, 1, 1];
  const values = [3, Infinity, 0.5, 0.9, 2, 4, 5, 0.3];
  const bytes = new DataView(new ArrayBuffer(8 * header.length + 4 * values.length));
  for (const [i, value] of header.entries()) bytes.setFloat64(8 * i, value, true);
  for (const [i, value] of values.entries()) bytes.setFloat32(8 * header.length + 4 * i, value, true);
  return bytes;
}

test("a frame is read as Python packs it", () => {
  const { time, robot, scan, path, obstacles } = toScene(frame()) as Scene;
  assert.deepEqual([time, robot], [1.5, { x: 1, y: 2, yaw: 0.5, radius: 0.2 }]);
  assert.deepEqual([scan.yaw, scan.angleMin, scan.rangeMax, [...scan.ranges]], [0.4, -1, 6, [3, Infinity]]);
  assert.deepEqual(
    path.map(({ x, y }) => [x, y].map(Math.fround)),
    [[Math.fround(0.9), 2]],
  );
  assert.deepEqual(obstacles, [{ x: 4, y: 5, radius: Math.fround(0.3) }]);
  assert.equal(toScene(new DataView(new ArrayBuffer(0))), null);
  assert.equal(toWalls(null).length, 0);
});

test("a ray without a thing in range ends at its reach, and one without a reading has no end", () => {
  const [met, free, none] = endsOf(scene().scan);
  assert.deepEqual([met, none], [{ x: 1, y: 0 }, null]);
  assert.ok(free && Math.abs(free.y - 4) < 1e-12);
});

test("the floor holds walls, obstacles and a robot beyond them, and has a least size without walls", () => {
  assert.deepEqual(boundsOf([ROOM], scene()), { west: -2, east: 2, south: -1, north: 1 });
  const away = withThing(scene(), "robot", { x: 5.3, y: 0, yaw: 0 });
  assert.deepEqual(boundsOf([ROOM], away), { west: -2, east: 6, south: -1, north: 1 });
  const beside = boundsOf([ROOM, Float32Array.of(1, 0, 4, 1)], scene());
  assert.equal(beside.east, 4, "a drop beyond the walls is shown, too");
  const open = boundsOf([new Float32Array()], { ...scene(), obstacles: [] });
  assert.deepEqual(open, { west: -4, east: 4, south: -4, north: 4 });
});

test("the picture is to scale, north up, and places come back from pixels", () => {
  const projection = fit(boundsOf([ROOM], scene()), { width: 424, height: 440 });
  assert.equal(projection.scale, 100);
  const [west, north] = [toPixel(projection, { x: -2, y: 0 }), toPixel(projection, { x: 0, y: 1 })];
  assert.equal(west.x, 12);
  assert.equal(west.y - north.y, 100);
  assert.deepEqual(toFloor(projection, toPixel(projection, { x: 0.5, y: -0.25 })), { x: 0.5, y: -0.25 });
});

test("the nearest thing within the slop is grabbed", () => {
  const projection = fit(boundsOf([ROOM], scene()), { width: 424, height: 440 });
  const at = (x: number, y: number, slop = 6) => thingAt(projection, scene(), toPixel(projection, { x, y }), slop);
  assert.deepEqual([at(0.1, 0), at(1.1, 0.5), at(-1.5, 0)], ["robot", 0, null]);
  assert.equal(thingAt(projection, scene(), handleOf(projection, scene().robot), 6), "heading");
  assert.deepEqual([at(-0.3, 0), at(-0.3, 0, 16)], [null, "robot"]);
});

test("a thing is dragged, turned and moved by keys", () => {
  const pose = poseOf(scene(), "robot");
  assert.deepEqual(draggedTo(pose, "robot", { x: 0.1, y: 0 }, { x: 1.1, y: 0.5 }), { x: 1, y: 0.5, yaw: Math.PI / 2 });
  assert.deepEqual(draggedTo(pose, "heading", { x: 0.3, y: 0 }, { x: 1, y: 0 }), { x: 0, y: 0, yaw: 0 });
  assert.deepEqual(movedBy("ArrowUp", true, { x: 0, y: 0, yaw: 0 }), { x: 0, y: 0.5, yaw: 0 });
  assert.equal(movedBy("[", false, { x: 0, y: 0, yaw: 0 })?.yaw, Math.PI / 12);
  assert.equal(movedBy("x", false, pose), null);
  const turned = Array.from({ length: 30 }).reduce<Pose>((before) => movedBy("[", false, before) ?? before, pose);
  assert.ok(Math.abs(turned.yaw) <= Math.PI, "never more than half a turn to either side");
});

test("a moved thing stays at its place until Python has answered the last edit and sent a frame", () => {
  const model = new FakeModel();
  const sent: { edit: string; x: number }[] = [];
  const refusals: string[] = [];
  const ours = Object.assign(model.model, { send: (content: never) => sent.push(content) });
  const edits = new Edits(ours, "a", (why) => refusals.push(why), new AbortController().signal);
  edits.move("robot", { x: 1, y: 0, yaw: 0 }, true);
  edits.move("robot", { x: 1.5, y: 0, yaw: 0 }, true);
  edits.move("robot", { x: 1.8, y: 0, yaw: 0 });
  assert.deepEqual(
    sent.map(({ x }) => x),
    [1, 1.8],
    "a place in between is not sent",
  );
  const shown = () => edits.apply(scene()).robot.x;
  model.tell({ edit: "a-1", refused: "" });
  edits.onFrame();
  assert.equal(shown(), 1.8, "an earlier edit");
  model.tell({ edit: "a-2", refused: "" });
  assert.equal(shown(), 1.8, "no frame yet");
  edits.onFrame();
  assert.equal(shown(), 0);
  edits.move(0, { x: 9, y: 9, yaw: 0 });
  assert.equal(edits.apply(scene()).obstacles[0]?.x, 9);
  model.tell({ edit: "a-3", refused: "no room" });
  assert.deepEqual([edits.thing, refusals], [null, ["no room"]]);
});

test("removed obstacles stay away, and later edits refer to the remaining ones", () => {
  const model = new FakeModel();
  const sent: { act: string; index: number }[] = [];
  const ours = Object.assign(model.model, { send: (content: never) => sent.push(content) });
  const edits = new Edits(ours, "a", () => {}, new AbortController().signal);
  const discs = [1, 2, 3, 4].map((x) => ({ x, y: 0, radius: 0.1 }));
  const shown = (left = discs) => edits.apply({ ...scene(), obstacles: left }).obstacles.map(({ x }) => x);
  edits.move(2, { x: 9, y: 0, yaw: 0 });
  edits.remove(1);
  edits.remove(0);
  assert.deepEqual(shown(), [9, 4], "the moved one has another index now");
  edits.remove(1);
  assert.deepEqual(
    sent.map(({ act, index }) => [act, index]),
    [
      ["move", 2],
      ["remove", 1],
      ["remove", 0],
      ["remove", 1],
    ],
  );
  model.tell({ edit: "a-1", refused: "" });
  model.tell({ edit: "a-2", refused: "" });
  edits.onFrame();
  const [first, , , last] = discs;
  assert.deepEqual(shown([first, { x: 9, y: 0, radius: 0.1 }, last] as typeof discs), [9], "those not made yet");
  model.tell({ edit: "a-3", refused: "" });
  model.tell({ edit: "a-4", refused: "expected an obstacle" });
  edits.onFrame();
  assert.deepEqual(shown([{ x: 9, y: 0, radius: 0.1 }, last] as typeof discs), [9, 4], "the last one was refused");
});

test("a place ahead and left of the scanner lies in the heading of the robot", () => {
  const scan = { ...scene().scan, x: 2, y: 1, yaw: Math.PI / 2 };
  const rounded = ({ x, y }: { x: number; y: number }) => [x, y].map((value) => Number(value.toFixed(6)));
  assert.deepEqual(rounded(toPlace(scan, [1, 0.5])), [1.5, 2]);
  const ray = endsOf({ ...scan, angleMin: Math.PI / 2 })[0];
  assert.deepEqual(ray && rounded(ray), [1, 1], "so do its rays");
});

/** A context that draws nothing, and records its calls. */
function recorder(): { calls: [string, ...unknown[]][]; context: CanvasRenderingContext2D } {
  const calls: [string, ...unknown[]][] = [];
  const context = new Proxy(
    {},
    {
      get:
        (_, name) =>
        (...given: unknown[]) =>
          calls.push([String(name), ...given]) && { width: 30 },
      set: () => true,
    },
  );
  return { calls, context: context as CanvasRenderingContext2D };
}

test("a drop is hatched to scale, in any order of its corners, and has its name if there is room", () => {
  const { calls, context } = recorder();
  const projection = fit({ west: -2, east: 2, south: -2, north: 2 }, { width: 424, height: 440 });
  drawDrops(context, projection, Float32Array.of(1, 1, 0, -1, -2, 0, -1.75, 2), {} as Theme);
  const { x, y } = toPixel(projection, { x: 0, y: 1 });
  const { x: west, y: north } = toPixel(projection, { x: -2, y: 2 });
  const named = (name: string) => calls.filter(([called]) => called === name).map(([, ...given]) => given);
  assert.deepEqual(named("rect"), [
    [x, y, 100, 200],
    [west, north, 25, 200],
  ]);
  assert.deepEqual(named("fillText"), [["drop", x + 50, y + 100]]);
  assert.ok(named("lineTo").length > 30);
});

test("shapes of a program stand at their places in the room, seen from the scanner, and have their names", () => {
  const { calls, context } = recorder();
  const shapes: RoomShape[] = [
    { name: "gap", kind: "line", at: [0, [0, 1]], turned: 0 },
    {
      name: "gap",
      kind: "line",
      at: [
        [1, 1],
        [1, 0.5],
      ],
      turned: 0,
    },
    { name: "gone", kind: "points", at: [1], turned: 0 },
  ];
  const shown = { ...scene(), scan: { ...scene().scan, yaw: Math.PI / 2 } };
  const projection = fit({ west: -2, east: 2, south: -2, north: 2 }, { width: 424, height: 440 });
  drawShapes(context, projection, shown, shapes, {} as Theme);
  const pixels = calls
    .filter(([name]) => /moveTo|lineTo/.test(name))
    .map(([, x, y]) => [x, y].map(Number).map(Math.round));
  const at = (x: number, y: number) => Object.values(toPixel(projection, { x, y })).map(Math.round);
  assert.deepEqual(pixels.slice(0, 2), [at(0, 1), at(-1, 0)], "the reading of a ray, and a place to its left");
  assert.deepEqual(
    calls.filter(([name]) => name === "fillText").map(([, text]) => text),
    ["gap"],
    "no ray, no shape",
  );
  calls.length = 0;
  drawShapes(context, projection, shown, [{ ...(shapes[0] as RoomShape), turned: Math.PI }], {} as Theme);
  const turned = calls
    .filter(([name]) => /moveTo|lineTo/.test(name))
    .map(([, x, y]) => [x, y].map(Number).map(Math.round));
  assert.deepEqual(
    turned.slice(0, 2),
    [at(0, 1), at(1, 0)],
    "a widget that turns the scanner round means the other side",
  );
});
