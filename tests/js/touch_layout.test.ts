import assert from "node:assert/strict";
import { test } from "node:test";
import type { Box } from "../../robowidgets/js/shared/box.ts";
import { layAround, spread } from "../../robowidgets/js/touch/around.ts";
import { layRows, toRows } from "../../robowidgets/js/touch/rows.ts";

const KOBUKI = ["left", "center", "right", "cliff left", "cliff center", "cliff right", "wheel left", "wheel right"];

function overlap(a: Box, b: Box): boolean {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

function assertApart(boxes: Iterable<Box>, width: number, height: number): void {
  const all = [...boxes];
  all.forEach((box, i) => {
    assert.ok(box.x >= -1e-9 && box.x + box.width <= width + 1e-9, `box ${i} within the width`);
    assert.ok(box.y >= -1e-9 && box.y + box.height <= height + 1e-9, `box ${i} within the height`);
    for (const other of all.slice(i + 1)) assert.ok(!overlap(box, other), `box ${i} lies over another`);
  });
}

test("sensors that fit in one row stay in one row, of any kinds", () => {
  assert.deepEqual(toRows(KOBUKI, 8), [KOBUKI]);
  assert.deepEqual(toRows([], 8), []);
});

test("without enough room each kind has separate rows", () => {
  assert.deepEqual(toRows(KOBUKI, 7), [KOBUKI.slice(0, 3), KOBUKI.slice(3, 6), KOBUKI.slice(6)]);
});

test("a kind that is too long is divided evenly", () => {
  const five = ["a", "b", "c", "d", "e"];
  assert.deepEqual(toRows(five, 4), [
    ["a", "b", "c"],
    ["d", "e"],
  ]);
  assert.deepEqual(toRows(five, 1), [["a"], ["b"], ["c"], ["d"], ["e"]]);
});

test("rows fill the width from left to right", () => {
  const { boxes, bottom } = layRows(["left", "center", "right"], 316, 0);
  assert.deepEqual(
    [...boxes.values()].map(({ x, width }) => [x, width]),
    [
      [0, 100],
      [108, 100],
      [216, 100],
    ],
  );
  assert.equal(bottom, boxes.get("left")?.height);
  assertApart(boxes.values(), 316, bottom);
});

test("rectangles of many are lower, and higher again if their words need separate lines", () => {
  const height = (names: string[], width: number, y = 0) => layRows(names, width, y).boxes.get(names[0] ?? "")?.height;
  const alone = height(["left"], 600);
  const many = height(KOBUKI, 600);
  const narrow = height(KOBUKI, 300);
  assert.ok(alone !== undefined && many !== undefined && narrow !== undefined);
  assert.ok(many < narrow && narrow < alone);
  assert.equal(height(["left"], 600, 50), many);
});

test("in a low room, rows are fewer and lower, but high enough for a label and a state", () => {
  const { boxes, bottom } = layRows(KOBUKI, 385, 0, 80);
  assert.equal(boxes.size, 8);
  assert.equal(new Set([...boxes.values()].map(({ y }) => y)).size, 2);
  assert.equal(bottom, 80);
  assertApart(boxes.values(), 385, bottom);
  assert.equal(layRows(["left", "right"], 385, 0, 80).bottom, 80, "a single row, too");
  assert.deepEqual(layRows(KOBUKI, 385, 0, 1000), layRows(KOBUKI, 385, 0), "with room enough nothing changes");
  const lowest = layRows(KOBUKI, 100, 0, 80);
  assert.ok([...lowest.boxes.values()].every(({ height }) => height === 31));
  assert.ok(lowest.bottom > 80, "it scrolls");
  assert.deepEqual(layRows([], 385, 0, 10), { boxes: new Map(), bottom: 0 });
});

test("without sensors the layout takes no room", () => {
  assert.deepEqual(layRows([], 300, 40), { boxes: new Map(), bottom: 40 });
});

test("hundreds of sensors keep apart at any width", () => {
  const names = Array.from({ length: 200 }, (_, i) => `sensor ${i}`);
  for (const width of [60, 296, 736]) {
    const { boxes, bottom } = layRows(names, width, 0);
    assert.equal(boxes.size, 200);
    assertApart(boxes.values(), width, bottom);
  }
});

const CREATE3 = new Map([
  ["left", 1.15],
  ["front left", 0.6],
  ["center", 0],
  ["front right", -0.6],
  ["right", -1.15],
  ["rear left", 3.1],
  ["rear right", -3.1],
]);

test("sensors lie on their side of the body, forward up and left on the left", () => {
  const { boxes, center, radius } = layAround(CREATE3, 676);
  const middle = (name: string) => {
    const { x, y, width, height } = boxes.get(name) as Box;
    return { x: x + width / 2, y: y + height / 2 };
  };
  assert.ok(middle("center").y < center.y - radius);
  assert.ok(middle("left").x < center.x - radius && middle("right").x > center.x + radius);
  assert.ok(middle("front left").y < middle("left").y);
  assert.ok(middle("front right").y < middle("right").y);
  assert.ok(middle("rear left").y > center.y + radius);
  assert.ok(middle("rear left").x < middle("rear right").x);
});

test("sensors ahead stand from left to right", () => {
  const { boxes } = layAround(
    new Map([
      ["r", -0.2],
      ["l", 0.2],
      ["c", 0],
    ]),
    676,
  );
  const x = (name: string) => (boxes.get(name) as Box).x;
  assert.ok(x("l") < x("c") && x("c") < x("r"));
});

test("rectangles keep apart, stay inside and never cover the body, at any width and for any angles", () => {
  let seed = 1;
  const random = () => {
    seed = (seed * 16807) % 2147483647;
    return seed / 2147483647;
  };
  for (let i = 0; i < 300; i += 1) {
    const count = 1 + Math.floor(random() * 14);
    const angles = new Map(Array.from({ length: count }, (_, k) => [`s${k}`, (random() - 0.5) * 20]));
    const width = 230 + random() * 520;
    const { boxes, center, radius, height, leads } = layAround(angles, width);
    assert.equal(boxes.size, count);
    assert.equal(leads.length, count);
    const body = { x: center.x - radius, y: center.y - radius, width: 2 * radius, height: 2 * radius };
    assertApart([...boxes.values(), body], width, height);
  }
});

test("lines go from the place on the body to the edge that faces it", () => {
  const { leads, boxes, center, radius } = layAround(
    new Map([
      ["left", Math.PI / 2],
      ["ahead", 0],
    ]),
    676,
  );
  const left = leads.find(({ name }) => name === "left");
  const box = boxes.get("left") as Box;
  assert.ok(left);
  assert.ok(Math.abs(left.from.x - (center.x - radius)) < 1e-9 && Math.abs(left.from.y - center.y) < 1e-9);
  assert.deepEqual(left.to, { x: box.x + box.width, y: box.y + box.height / 2 });
  const ahead = leads.find(({ name }) => name === "ahead");
  const above = boxes.get("ahead") as Box;
  assert.deepEqual(ahead?.to, { x: center.x, y: above.y + above.height });
});

test("angles beyond a full turn are at their directions", () => {
  const { leads } = layAround(new Map([["left", Math.PI / 2 + 4 * Math.PI]]), 500);
  assert.ok(Math.abs((leads[0]?.angle ?? 0) - Math.PI / 2) < 1e-9);
});

test("positions stay as wanted if there is room, and give way in order if not", () => {
  assert.deepEqual(spread([10, 40, 90], 20, 0, 100), [10, 40, 90]);
  assert.deepEqual(spread([10, 12, 14], 20, 0, 100), [10, 30, 50]);
  assert.deepEqual(spread([90, 95, 99], 20, 0, 100), [60, 80, 100]);
  assert.deepEqual(spread([-50], 20, 0, 100), [0]);
});
