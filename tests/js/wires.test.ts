import assert from "node:assert/strict";
import { test } from "node:test";
import { overlaps } from "../../robowidgets/js/shared/box.ts";
import { around, type Graph, MANY, toGraph } from "../../robowidgets/js/wires/graph.ts";
import { beside, type Placed, place } from "../../robowidgets/js/wires/layout.ts";
import { fitted, scaled, shifted, whole } from "../../robowidgets/js/wires/sight.ts";
import type { Part, Wire, Wiring } from "../../robowidgets/js/wires/wiring.ts";
import { describe, isSilent, rateOf, sayingOf } from "../../robowidgets/js/wires/words.ts";

const ALL = { filter: "", infrastructure: false, unfolded: [] };

/** Wires from "from from -> /topic -> to to". */
function wiring(lines: string[], parts: Part[] = []): Wiring {
  const nodes: string[] = [];
  const number = (name: string) => (nodes.includes(name) ? nodes.indexOf(name) : nodes.push(name) - 1);
  const wires = lines.map((line): Wire => {
    const [from = "", name = "", to = ""] = line.split(" -> ");
    const split = (names: string) => names.split(" ").filter(Boolean).map(number);
    const plumbing = name === "/rosout";
    return { name, type: "std_msgs/msg/Float64", from: split(from), to: split(to), heard: true, plumbing };
  });
  return { nodes, tells: nodes.length > 0, note: "", wires, parts };
}

const measure = (text: string) => 7 * text.length;
const keys = ({ items }: Graph) => [...items.keys()].sort();

const ROBOT = wiring(
  [
    "/lidar -> /scan -> /amcl /nav",
    "/base -> /odom -> /amcl",
    "/nav -> /cmd_vel -> /base",
    "/lidar /base -> /rosout -> /rosout",
    " -> /goal -> /nav",
  ],
  [
    { kind: "program", name: "avoid", reads: ["/scan"], drives: true },
    { kind: "function", name: "look", reads: ["/scan"] },
    { kind: "speeds", name: "speeds", writes: ["/cmd_vel"] },
  ],
);

test("messages go from the publisher by the topic to the subscriber, and speeds from the program to the robot", () => {
  const { items, links, plumbing } = toGraph(ROBOT, ALL);
  assert.equal(items.size, 4 + 4 + 3);
  const ways = links.map((link) => link.join(" > "));
  for (const way of [
    "node /lidar > topic /scan",
    "topic /scan > node /amcl",
    "topic /scan > program avoid 0",
    "program avoid 0 > speeds speeds 0",
    "speeds speeds 0 > topic /cmd_vel",
    "topic /cmd_vel > node /base",
  ]) {
    assert.ok(ways.includes(way), way);
  }
  assert.equal(plumbing, 1);
  assert.deepEqual([...around({ links }, "topic /odom")].sort(), ["node /amcl", "node /base", "topic /odom"]);
});

test("items that every node has are shown on request", () => {
  const graph = toGraph(ROBOT, { ...ALL, infrastructure: true });
  assert.ok(graph.items.has("topic /rosout"));
  assert.ok(graph.items.has("node /rosout"));
  assert.equal(graph.plumbing, 0);
});

test("a filter keeps the items whose names contain the text, and their neighbours", () => {
  const graph = toGraph(ROBOT, { ...ALL, filter: " SCAN " });
  assert.deepEqual(keys(graph), [
    "function look 0",
    "node /amcl",
    "node /lidar",
    "node /nav",
    "program avoid 0",
    "topic /scan",
  ]);
  assert.ok(graph.links.every((link) => link.includes("topic /scan")));
  assert.equal(graph.filtered, 5);
  assert.equal(toGraph(ROBOT, { ...ALL, filter: "nonsense" }).items.size, 0);
});

test("two functions of one name are two boxes", () => {
  const twice: Part[] = [0, 1].map(() => ({ kind: "function", name: "look", reads: ["/scan"] }));
  assert.equal(toGraph(wiring(["/lidar -> /scan -> "], twice), ALL).items.size, 4);
});

const LARGE = wiring([
  ...Array.from({ length: 90 }, (_, i) => `/camera/driver -> /camera/${i}/image -> /detector`),
  ...Array.from({ length: 90 }, (_, i) => `/arm/motor_${i} -> /arm/joint_${i} -> /arm/controller`),
  ...Array.from({ length: 20 }, (_, i) => `/base -> /plain_${i} -> /nav`),
]);

test("namespaces of a large graph are folded, the largest first, and the user can unfold them", () => {
  const few = toGraph(wiring(["/a/x -> /b/one -> ", "/a/x -> /b/two -> ", "/a/x -> /b/three -> "]), ALL);
  assert.ok(![...few.items.values()].some(({ kind }) => kind === "fold"));
  const graph = toGraph(LARGE, ALL);
  assert.ok(graph.items.size <= MANY, String(graph.items.size));
  assert.equal(graph.items.get("topics /camera")?.members?.length, 90);
  assert.equal(graph.items.get("nodes /arm")?.members?.length, 91);
  assert.ok(graph.links.some(([from, to]) => from === "nodes /arm" && to === "topics /arm"));
  assert.equal(new Set(graph.links.map((link) => link.join(" > "))).size, graph.links.length);
  const open = toGraph(LARGE, { ...ALL, unfolded: ["topics /camera"] });
  assert.ok(open.items.has("topic /camera/7/image"));
  assert.ok(!open.items.has("topics /camera"));
});

function check(placed: Placed): void {
  const boxes = [...placed.boxes];
  for (const [i, [name, box]] of boxes.entries()) {
    assert.ok(box.x >= 0 && box.y >= 0 && box.x + box.width <= placed.width + 1e-6, name);
    assert.ok(box.y + box.height <= placed.height + 1e-6, name);
    for (const [other, another] of boxes.slice(i + 1)) assert.ok(!overlaps(box, another), `${name} on ${other}`);
  }
  for (const { from, to, points } of placed.links) {
    const [start, end] = [placed.boxes.get(from), placed.boxes.get(to)];
    assert.ok(start && end);
    const [[x = 0, y = 0] = [], [u = 0, v = 0] = []] = [points[0], points.at(-1)];
    assert.ok(
      Math.min(Math.abs(x - start.x), Math.abs(x - start.x - start.width)) < 1e-6,
      `${from} begins at its side`,
    );
    assert.ok(y >= start.y && y <= start.y + start.height);
    assert.ok(Math.min(Math.abs(u - end.x), Math.abs(u - end.x - end.width)) < 1e-6, `${to} is entered at its side`);
    assert.ok(v >= end.y && v <= end.y + end.height);
    for (const [i, [a, b]] of points.slice(1).entries()) {
      const [c, d] = points[i] as [number, number];
      assert.ok(Math.abs(a - c) < 1e-6 || Math.abs(b - d) < 1e-6, "wires run along the axes");
    }
  }
}

test("boxes lie apart, and wires lead from side to side", () => {
  for (const one of [ROBOT, LARGE, wiring(["", ""]), wiring([])]) check(place(toGraph(one, ALL), measure, 700));
  const { boxes } = place(toGraph(ROBOT, ALL), measure, 700);
  assert.ok((boxes.get("node /lidar")?.x ?? 0) < (boxes.get("topic /scan")?.x ?? 0));
});

test("a hundred nodes and three hundred topics are placed fast enough to look at them", () => {
  const lines = Array.from({ length: 300 }, (_, i) => `/node_${i % 100} -> /topic_${i} -> /node_${(i * 7 + 3) % 100}`);
  const graph = toGraph(wiring(lines), ALL);
  assert.equal(graph.items.size, 400);
  check(place(graph, measure, 700));
});

test("topics alone stand in rows as wide as the room", () => {
  const lines = Array.from({ length: 30 }, (_, i) => ` -> /topic_${i} -> `);
  const placed = place(toGraph(wiring(lines), ALL), measure, 700);
  check(placed);
  assert.ok(placed.width <= 700 && placed.width > 500, String(placed.width));
  assert.equal(placed.links.length, 0);
});

test("arrow keys walk to the next box in their direction", () => {
  const placed = place(toGraph(ROBOT, ALL), measure, 700);
  assert.equal(beside(placed, "node /lidar", 1, 0), "topic /scan");
  assert.equal(beside(placed, "topic /scan", -1, 0), "node /lidar");
  assert.ok(beside(placed, "nothing", 1, 0));
});

test("a picture is shown whole if it is readable so, else its left upper part", () => {
  assert.deepEqual(fitted({ width: 500, height: 100 }, { width: 700, height: 300 }), { scale: 1, x: 100, y: 100 });
  const large = fitted({ width: 5000, height: 100 }, { width: 700, height: 300 });
  assert.equal(large.x, 0);
  assert.ok(large.scale >= 0.7);
  assert.ok(whole({ width: 1400, height: 100 }, { width: 700, height: 300 }).scale === 0.5);
  const zoomed = scaled({ scale: 1, x: 10, y: 20 }, 2, { x: 110, y: 20 });
  assert.deepEqual(zoomed, { scale: 2, x: -90, y: 20 });
  const moved = shifted(
    { scale: 1, x: 0, y: 0 },
    { x: 9999, y: -9999 },
    { width: 500, height: 100 },
    { width: 700, height: 300 },
  );
  assert.ok(moved.x < 700 && moved.y > -100);
});

test("a topic shows its rate and its last message, and the reason without one", () => {
  const wire = { name: "/scan", type: "sensor_msgs/msg/LaserScan", from: [], to: [], heard: true, plumbing: false };
  assert.deepEqual([rateOf(wire), sayingOf(wire)], ["", "no message yet"]);
  const live = { ...wire, rate: 10, value: "nearest 0.5 m", age: 0.1 };
  assert.deepEqual([rateOf(live), sayingOf(live), isSilent(live)], ["10.0 Hz", "nearest 0.5 m", false]);
  assert.equal(sayingOf({ ...live, age: 12 }), "silent for 12.0 s");
  assert.deepEqual([isSilent({ ...live, age: 3 }), isSilent({ ...live, rate: 0.5, age: 6 })], [false, false]);
  // The widget did not listen in between.
  assert.equal(sayingOf({ ...live, age: 12, glanced: true }), "nearest 0.5 m");
  assert.equal(sayingOf({ ...live, note: "it is of an unknown type" }), "it is of an unknown type");
  assert.equal(sayingOf({ ...wire, offered: false }), "nobody publishes it");
  assert.equal(sayingOf({ ...wire, heard: false }), "LaserScan");
  assert.deepEqual([rateOf({ ...wire, count: 1 }), rateOf({ ...wire, count: 1234 })], ["once", "1\u202f234 \u00d7"]);
});

test("the facts about the item under the pointer are complete", () => {
  const { items } = toGraph(ROBOT, ALL);
  const of = (key: string) => {
    const item = items.get(key);
    assert.ok(item);
    return describe(item, ROBOT);
  };
  assert.deepEqual(of("topic /scan").lines.at(-1), "from /lidar, to /amcl, /nav, here to avoid, look");
  assert.deepEqual(of("node /base").lines, ["publishes /odom, /rosout", "gets /cmd_vel"]);
  assert.deepEqual(of("program avoid 0").facts, ["not yet", "reads /scan", "drives"]);
  const fold = toGraph(LARGE, ALL).items.get("topics /camera");
  assert.ok(fold);
  assert.match(describe(fold, LARGE).lines[0] ?? "", /^\/camera\/0\/image, .* and 84 more$/);
});
