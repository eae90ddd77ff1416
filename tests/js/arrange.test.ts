import assert from "node:assert/strict";
import { test } from "node:test";
import {
  edgeAt,
  edgeBox,
  fromBoxes,
  grown,
  inserted,
  moved,
  namesOf,
  type Part,
  pack,
  placeWords,
  present,
  presetOf,
  read,
  resized,
  sharesOf,
  stepped,
  takesRest,
  toCode,
  toTwelfths,
  without,
  zoneAt,
} from "../../robowidgets/js/screen/tree.ts";

const KINDS: Record<string, string> = {
  scan: "laser",
  odom: "speed",
  bumper: "touch",
  plan: "plot",
  see: "image",
  where: "path",
};
const kindOf = (name: string) => KINDS[name] ?? "message";
const cards = (...names: string[]) => names.map((name) => ({ name, kind: kindOf(name) }));
const TREE = read({
  row: [
    { card: "scan", width: 8 },
    { column: ["odom", "bumper"], width: 4 },
  ],
});
const box = (x: number, y: number, width: number, height: number) => ({ x, y, width, height });
/** The boxes of TREE on a screen of 1200 by 600. */
const BOXES = new Map([
  ["scan", box(0, 0, 797, 600)],
  ["odom", box(801, 0, 399, 298)],
  ["bumper", box(801, 302, 399, 298)],
]);

test("an arrangement is stored as names, rows and columns, and read again", () => {
  const stored = { row: [{ card: "scan", width: 8 }, { column: ["odom", { card: "bumper", height: 144 }] }] };
  assert.deepEqual(pack(read(stored)), stored);
  assert.equal(pack(read("scan")), "scan");
  assert.deepEqual(namesOf(TREE), ["scan", "odom", "bumper"]);
});

test("a card is dropped at each side of another card, and of the screen", () => {
  const at = (target: string | null, side: "left" | "right" | "above" | "below") =>
    pack(inserted(TREE, { card: "plan" }, { target, side }));
  assert.deepEqual(at("odom", "above"), {
    row: [
      { card: "scan", width: 8 },
      { column: ["plan", "odom", "bumper"], width: 4 },
    ],
  });
  assert.deepEqual(at("odom", "right"), {
    row: [
      { card: "scan", width: 8 },
      { column: [{ row: ["odom", "plan"] }, "bumper"], width: 4 },
    ],
  });
  assert.deepEqual(at("scan", "below"), {
    row: [
      { column: ["scan", "plan"], width: 8 },
      { column: ["odom", "bumper"], width: 4 },
    ],
  });
  assert.deepEqual(at(null, "below"), { column: [pack(TREE), "plan"] });
  assert.deepEqual(at(null, "left"), {
    row: ["plan", { card: "scan", width: 8 }, { column: ["odom", "bumper"], width: 4 }],
  });
});

test("a card that leaves a column leaves no empty split, and loses its size", () => {
  assert.deepEqual(pack(moved(TREE, "odom", { target: "scan", side: "left" })), {
    row: ["odom", { card: "scan", width: 8 }, { card: "bumper", width: 4 }],
  });
  assert.deepEqual(without({ card: "scan" }, "scan"), null);
  assert.equal(moved(TREE, "odom", { target: "odom", side: "left" }), TREE);
});

test("cards that come later stand below, and those that are gone leave their places", () => {
  assert.deepEqual(present(TREE, cards("scan", "bumper", "plan")), {
    column: [
      {
        row: [
          { card: "scan", width: 8 },
          { card: "bumper", width: 4 },
        ],
      },
      { card: "plan" },
    ],
  });
  const named = [{ name: "/camera as image", kind: "image" }];
  assert.deepEqual(present({ card: "/camera" }, named), { card: "/camera as image" }, "its first widget");
  assert.equal(present(TREE, []), null);
});

test("arrows reach every place, and the place is said in words", () => {
  const right = stepped(TREE, "scan", "right");
  assert.deepEqual(pack(right), { column: ["scan", "odom", "bumper"] }, "into the column, which is alone then");
  const out = stepped(TREE, "odom", "left");
  assert.deepEqual(pack(out), { row: [{ card: "scan", width: 8 }, "odom", { card: "bumper", width: 4 }] });
  const down = stepped(TREE, "odom", "below");
  assert.deepEqual(namesOf(down), ["scan", "bumper", "odom"]);
  assert.equal(placeWords(down, "odom"), "second column, second of two");
  assert.equal(placeWords(TREE, "scan"), "first column");
  assert.deepEqual(pack(stepped(TREE, "scan", "above")), {
    column: ["scan", { column: ["odom", "bumper"] }].flatMap((part) =>
      typeof part === "string" ? [part] : part.column,
    ),
  });
  const alone: Part = { card: "scan" };
  assert.equal(stepped(alone, "scan", "left"), alone);
});

test("widths are shares, and whole twelfths while an edge is dragged", () => {
  assert.deepEqual(toTwelfths([0.62, 0.38]), [7, 5]);
  assert.deepEqual(toTwelfths([0.98, 0.01, 0.01]), [10, 1, 1]);
  assert.deepEqual(sharesOf([{ width: 6 }, { width: 2 }, {}]), [0.5, 1 / 6, 1 / 3], "the mean of the others");
  const edge = { path: [], index: 0, way: "row" as const };
  const widths = (by: number) => resized(TREE, edge, by, [797, 399], kindOf).row?.map(({ width }) => width);
  assert.deepEqual(widths(-100), [7, 5]);
  assert.deepEqual(widths(40), [8, 4], "less than half a twelfth");
  assert.deepEqual(widths(-2000), [3, 9], "a laser keeps 260 pixels");
  assert.deepEqual(widths(2000), [10, 2], "and the speeds 200");
  const pair = resized(read({ row: ["odom", "bumper"] }), edge, 500, [300, 300], kindOf);
  assert.deepEqual(
    pair.row?.map(({ width }) => width),
    [8, 4],
    "two touch sensors stay side by side",
  );
});

test("heights go in steps of 24 pixels, and the part that takes the rest has none", () => {
  const column = read({ column: ["scan", { card: "odom", height: 168 }] });
  const edge = { path: [], index: 0, way: "column" as const };
  assert.deepEqual(pack(resized(column, edge, -50, [400, 168], kindOf)), {
    column: ["scan", { card: "odom", height: 216 }],
  });
  assert.deepEqual(pack(resized(column, edge, 500, [400, 168], kindOf)), {
    column: ["scan", { card: "odom", height: 120 }],
  });
  assert.ok(takesRest({ row: [{ card: "odom" }, { card: "scan" }] }, kindOf));
  assert.ok(!takesRest({ card: "scan", height: 200 }, kindOf));
  const higher = grown(TREE, "bumper", "above", BOXES, kindOf);
  assert.deepEqual(pack(higher), {
    row: [
      { card: "scan", width: 8 },
      { column: [{ card: "odom", height: 312 }, "bumper"], width: 4 },
    ],
  });
  assert.deepEqual(
    grown(TREE, "odom", "right", BOXES, kindOf).row?.map(({ width }) => width),
    [7, 5],
  );
});

test("the pointer finds edges in the gaps, and places for a dragged card", () => {
  assert.deepEqual(edgeAt(TREE, BOXES, { x: 799, y: 100 }), { path: [], index: 0, way: "row" });
  const edge = edgeAt(TREE, BOXES, { x: 900, y: 300 });
  assert.deepEqual(edge, { path: [1], index: 0, way: "column" });
  assert.deepEqual(edge && edgeBox(TREE, edge, BOXES)?.line, box(801, 298.5, 399, 3));
  assert.equal(edgeAt(TREE, BOXES, { x: 400, y: 100 }), null);
  assert.deepEqual(zoneAt(BOXES, "odom", { x: 400, y: 500 }), { target: "scan", side: "below" });
  assert.deepEqual(zoneAt(BOXES, "odom", { x: 100, y: 300 }), { target: "scan", side: "left" });
  assert.deepEqual(zoneAt(BOXES, "odom", { x: 400, y: 595 }), { target: null, side: "below" });
  assert.equal(zoneAt(BOXES, "odom", { x: 900, y: 100 }), null, "over itself");
  assert.equal(zoneAt(BOXES, "odom", { x: 400, y: 900 }), null, "far outside");
});

test("a screen laid out by places becomes rows and columns of the same look", () => {
  const boxes = new Map([
    ["plan", box(0, 66, 696, 320)],
    ["odom", box(0, 390, 260, 172)],
    ["bumper", box(264, 390, 432, 172)],
    ["scan", box(700, 66, 400, 496)],
    ["see", box(0, 566, 1100, 300)],
  ]);
  assert.deepEqual(pack(fromBoxes(boxes, kindOf) ?? {}), {
    column: [
      {
        row: [
          {
            column: [
              "plan",
              {
                row: [
                  { card: "odom", width: 5 },
                  { card: "bumper", width: 7 },
                ],
                height: 168,
              },
            ],
            width: 8,
          },
          { card: "scan", width: 4 },
        ],
      },
      { card: "see", height: 312 },
    ],
  });
  assert.equal(fromBoxes(new Map(), kindOf), null);
});

test("a preset exists if a card is of its kind", () => {
  const there = cards("odom", "scan", "bumper", "plan");
  const row = [
    { card: "scan", width: 8 },
    { column: ["odom", "bumper"], width: 4 },
  ];
  assert.deepEqual(pack(presetOf("laser", there) ?? {}), { column: [{ row, height: 456 }, "plan"] });
  const two = [
    { card: "scan", width: 8 },
    { card: "odom", width: 4 },
  ];
  assert.deepEqual(pack(presetOf("laser", cards("odom", "scan")) ?? {}), { row: two });
  assert.deepEqual(pack(presetOf("plots", there) ?? {}), { column: ["plan", { row: ["odom", "scan", "bumper"] }] });
  assert.equal(presetOf("camera", there), null);
  const many = [...cards("scan", "odom", "bumper", "where"), { name: "rays", kind: "scanogram" }];
  const below = [
    { card: "rays", width: 8 },
    { card: "where", width: 4 },
  ];
  assert.deepEqual(
    pack(presetOf("laser", many) ?? {}),
    {
      column: [
        { row, height: 456 },
        { row: below, height: 240 },
      ],
    },
    "two at its side, so that they can show their numbers",
  );
  assert.equal(presetOf("laser", cards("scan")), null);
});

test("the code of an arrangement is Python", () => {
  assert.equal(
    toCode({ row: [{ card: "/scan" }, { card: 'a "b"', height: 144 }] }, ["/scan", ["/odom.x", "/odom.y"]]),
    `arrangement = {
    "topics": ["/scan", ["/odom.x", "/odom.y"]],
    "cards": {"row": ["/scan", {"card": "a \\"b\\"", "height": 144}]},
}
`,
  );
});
