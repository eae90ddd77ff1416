import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { Foresight } from "../../robowidgets/js/player/foresight.ts";
import { Stretches } from "../../robowidgets/js/player/stretches.ts";

/** A page that has the first two of many stretches; what it asks for; and time that passes when the test says so. */
function start() {
  let now = 0;
  performance.now = () => now;
  mock.timers.reset();
  mock.timers.enable({ apis: ["setTimeout"] });
  const stretches = new Stretches(1);
  const asked: number[] = [];
  const controller = new AbortController();
  const foresight = new Foresight(stretches, (time) => asked.push(time), controller.signal);
  const give = (index: number) => {
    stretches.put(index, []);
    foresight.came();
  };
  give(0);
  give(1);
  const pass = (ms: number) => {
    now += ms;
    mock.timers.tick(ms);
  };
  return { foresight, stretches, asked, give, pass, end: () => controller.abort() };
}

test("where the pointer rests is asked for once, where it only passes is not", () => {
  const { foresight, asked, give, pass } = start();
  for (const time of [3, 4, 5, 6]) {
    foresight.point(time);
    pass(16);
  }
  assert.deepEqual(asked, []);
  foresight.point(6.3);
  pass(16);
  assert.deepEqual(asked, [6]);
  for (let i = 0; i < 100; i++) {
    foresight.point(6 + (i % 10) / 10);
    pass(100);
  }
  give(6);
  pass(100);
  assert.deepEqual(asked, [6]);
});

test("nothing is asked for that is here, nor for a pointer that has left, nor after the end", () => {
  const { foresight, asked, pass, end } = start();
  foresight.point(1.5);
  pass(100);
  foresight.point(7);
  foresight.point(null);
  pass(100);
  foresight.point(7);
  end();
  pass(100);
  assert.deepEqual(asked, []);
});

test("one question is out at a time; the newest follows when the answer came", () => {
  const { foresight, asked, give, pass } = start();
  foresight.ask(7.5);
  for (const time of [20, 30, 40]) {
    foresight.point(time);
    pass(50);
  }
  give(8);
  assert.deepEqual(asked, [7.5]);
  give(7);
  assert.deepEqual(asked, [7.5, 40]);
});

test("what a pointer has left is not asked for when the answer came", () => {
  const { foresight, asked, give, pass } = start();
  foresight.ask(7.5);
  foresight.point(20);
  pass(50);
  foresight.point(null);
  give(7);
  assert.deepEqual(asked, [7.5]);
});

test("a kernel that does not answer is asked once a second at most", () => {
  const { foresight, asked, pass } = start();
  for (let time = 10; time < 110; time++) {
    foresight.point(time);
    pass(50);
  }
  assert.ok(asked.length >= 4 && asked.length <= 5, String(asked));
});
