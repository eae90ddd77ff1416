import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { throttle } from "../../robowidgets/js/shared/schedule.ts";

function open() {
  mock.timers.enable({ apis: ["setTimeout"] });
  const controller = new AbortController();
  const calls: number[] = [];
  let asked = 0;
  const call = throttle(() => calls.push(asked), 100, controller.signal);
  const ask = () => {
    asked++;
    call();
  };
  return { ask, calls, end: () => controller.abort(), close: () => mock.timers.reset() };
}

test("the first is heard at once, and so is one after a rest", () => {
  const { ask, calls, close } = open();
  ask();
  assert.deepEqual(calls, [1]);
  mock.timers.tick(100);
  ask();
  assert.deepEqual(calls, [1, 2]);
  close();
});

test("a flood is heard ten times a second, the last included", () => {
  const { ask, calls, close } = open();
  for (let i = 0; i < 100; i++) {
    ask();
    mock.timers.tick(10);
  }
  mock.timers.tick(100);
  assert.deepEqual(calls, [1, 10, 20, 30, 40, 50, 60, 70, 80, 90, 100]);
  close();
});

test("after the end nobody is heard", () => {
  const { ask, calls, end, close } = open();
  ask();
  ask();
  end();
  mock.timers.tick(1000);
  ask();
  assert.deepEqual(calls, [1]);
  close();
});
