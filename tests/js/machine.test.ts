import assert from "node:assert/strict";
import { test } from "node:test";
import { type Placed, place } from "../../robowidgets/js/machine/layout.ts";
import { activeText, isTaken, type Step, timeLeft, verdictOf } from "../../robowidgets/js/machine/step.ts";
import type { Fired, MachineOutline, MoveOutline, StateOutline } from "../../robowidgets/js/machine/traits.ts";
import type { Box } from "../../robowidgets/js/shared/box.ts";

function state(name: string, path: string, machines: MachineOutline[] = []): StateOutline {
  return { name, path: `${path}.${name}`, machines };
}

function move(words: string): MoveOutline {
  const [source = "", target = "", how = "", why = ""] = words.split(" ");
  return {
    source,
    target,
    event: how === "on" ? why : null,
    after: how === "after" ? why : null,
    why: `${how} ${why}`,
    compares: why === "near",
  };
}

const turning: MachineOutline = {
  path: "Walker.avoid",
  states: [..."stop back decide left right finish".split(" ").map((name) => state(name, "Walker.avoid"))],
  moves: [
    "stop back at once",
    "back decide after 0.5",
    "back stop after 4",
    "decide left on near",
    "decide right on far",
    "left finish after pause",
    "right finish after 1",
    "right right on near",
  ].map(move),
};
const looking: MachineOutline = {
  path: "Walker.avoid.look",
  states: [state("near", "x"), state("far", "x")],
  moves: ["near far on far", "far near on near"].map(move),
};
const walker: MachineOutline = {
  path: "Walker",
  states: [
    state("forward", "Walker"),
    state("avoid", "Walker", [turning, looking]),
    state("halt", "Walker"),
    state("wait", "Walker"),
  ],
  moves: [
    "* halt on asked",
    "forward avoid on near",
    "forward avoid on bumped",
    "avoid forward on done",
    "halt wait after 1",
    "wait forward on near",
  ].map(move),
};

const ALL = { measure: (text: string) => 7 * text.length, room: 900, isOpen: () => true };

function overlap(a: Box, b: Box): boolean {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

/** A line of an arrow as a box, a little within its ends. */
function lines({ moves }: Placed): Box[] {
  return moves.flatMap(({ points }) =>
    points.slice(1).map(([x, y], i) => {
      const [fromX, fromY] = points[i] as [number, number];
      const [width, height] = [Math.abs(x - fromX), Math.abs(y - fromY)];
      assert.ok(width < 0.01 || height < 0.01, "arrows are orthogonal");
      return { x: Math.min(x, fromX) + 0.1, y: Math.min(y, fromY) + 0.1, width: width - 0.2, height: height - 0.2 };
    }),
  );
}

for (const room of [900, 300]) {
  test(`boxes, words and arrows keep apart, and within the picture, in ${room} pixels`, () => {
    const placed = place([walker], { ...ALL, room });
    const { states, moves, any, width, height } = placed;
    assert.equal(states.length, 12);
    const solid = [...states.filter(({ isOpen }) => !isOpen), ...any, ...moves.map(({ label }) => label)];
    for (const [i, box] of solid.entries()) {
      assert.ok(box.x >= 0 && box.y >= 0 && box.x + box.width <= width && box.y + box.height <= height);
      for (const other of solid.slice(i + 1)) assert.ok(!overlap(box, other), JSON.stringify([box, other]));
    }
    for (const line of lines(placed)) {
      const flat = { ...line, width: Math.max(line.width, 0), height: Math.max(line.height, 0) };
      assert.ok(flat.x >= 0 && flat.x + flat.width <= width, "an arrow lies within");
      for (const box of solid) assert.ok(!overlap(flat, box), JSON.stringify([flat, box]));
    }
    const [, avoid] = states;
    const inner = states.filter(({ machine }) => machine === turning || machine === looking);
    for (const box of inner) assert.ok(avoid && box.x > avoid.x && box.y + box.height < avoid.y + avoid.height);
  });
}

test("arrows near a loop keep clear of its state, and its words stand next to it", () => {
  const states = [..."search approach grab drop".split(" ").map((name) => state(name, "m"))];
  const moves = ["search search after 2", "search approach on lost", "search grab on lost", "search drop after 3"];
  const back = ["approach search on near", "grab search on near", "drop search after 1", "grab drop after 1"];
  const placed = place([{ path: "m", states, moves: [...moves, ...back].map(move) }], ALL);
  const { points: loop = [], label } = placed.moves[0] ?? {};
  const search = placed.states[0] as Box;
  assert.equal(label?.x, search.x + search.width + 18);
  for (const { y, height } of lines({ ...placed, moves: placed.moves.filter(({ points }) => points !== loop) })) {
    if (height > 0) continue;
    for (const box of placed.states) assert.ok(y < box.y - 1 || y > box.y + box.height + 1, `a line at ${y}`);
  }
});

test("machines stand side by side if there is room, and below each other if not", () => {
  const [first, second] = place([turning, looking], ALL).lanes;
  assert.ok(first && second && second.x >= first.x + first.width);
  const [upper, lower] = place([turning, looking], { ...ALL, room: 200 }).lanes;
  assert.ok(upper && lower && lower.y >= upper.y + upper.height);
});

test("a folded machine, or one deeper than three levels, is drawn as a state", () => {
  assert.equal(place([walker], { ...ALL, isOpen: () => false }).states.length, 4);
  const wrap = (machine: MachineOutline): MachineOutline => ({
    path: "w",
    states: [state("w", "w", [machine]), state("z", "w")],
    moves: [move("w z after 1")],
  });
  const deep = place([wrap(wrap(wrap(wrap(looking))))], ALL);
  assert.deepEqual(deep.states.map(({ isOpen }) => isOpen).slice(0, 4), [true, true, true, false]);
  assert.equal(deep.states.length, 8);
});

function step(values: Partial<Step> = {}): Step {
  const states = { Walker: ["avoid", 2.0], "Walker.avoid": ["left", 2.5], "Walker.avoid.look": ["far", 2.0] };
  return {
    sequence: 1,
    rate: 20,
    arrived: 9,
    key: "Walker 1",
    time: 3,
    states,
    judged: [],
    seconds: [],
    ...values,
  } as Step;
}

test("the text of active states includes nested machines", () => {
  assert.equal(activeText([walker], step()), "avoid \u203a left + far");
  assert.equal(activeText([walker], step({ states: { Walker: ["gone", 0] } })), "");
});

test("the time left belongs to the next time-out, whose length a variable may set", () => {
  const left = turning.states[3] as StateOutline;
  assert.equal(timeLeft(turning, left, step()), null);
  assert.deepEqual(timeLeft(turning, left, step({ seconds: [["Walker.avoid", "pause", 2]] })), [1.5, 2]);
  const back = turning.states[1] as StateOutline;
  const states = { "Walker.avoid": ["back", 1.0] } as Step["states"];
  assert.deepEqual(timeLeft(turning, back, step({ states })), [0, 0.5]);
});

test("an event that was not judged in the step is unknown, even if it had a value before", () => {
  const near = walker.moves[1] as MoveOutline;
  assert.deepEqual(verdictOf(walker, near, step()), ["unknown", ""]);
  const judged: Step["judged"] = [["Walker", "near", true, "0.43 < 0.55 m"]];
  assert.deepEqual(verdictOf(walker, near, step({ judged })), ["true", "0.43 < 0.55 m"]);
  assert.deepEqual(verdictOf(walker, near, step({ judged: [["Walker", "near", null, ""]] })), ["unknown", ""]);
});

test("the taken move is the last one up to the step, also one from any state", () => {
  const made = (time: number, source: string, target: string, why: string): Fired => {
    return { at: time, time, machine: "Walker", source, target, why, reading: "", index: null };
  };
  const fired = [made(2, "forward", "avoid", "on near"), made(4, "avoid", "halt", "on asked")];
  const taken = (now: Step) => walker.moves.filter((one) => isTaken(walker, one, fired, now)).map(({ event }) => event);
  assert.deepEqual(taken(step()), ["near"]);
  assert.deepEqual(taken(step({ time: 5, states: { Walker: ["halt", 4] } })), ["asked"]);
});
