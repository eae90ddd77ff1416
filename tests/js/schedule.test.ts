import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { Texts, throttle } from "../../robowidgets/js/shared/schedule.ts";

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

function openTexts() {
  mock.timers.enable({ apis: ["setTimeout"] });
  let now = 1000;
  const clock = mock.method(performance, "now", () => now);
  const end = new AbortController();
  const texts = new Texts(end.signal);
  const written: number[] = [];
  const write = () => written.push(now - 1000);
  const pass = (ms: number) => {
    now += ms;
    mock.timers.tick(ms);
  };
  const close = () => {
    clock.mock.restore();
    mock.timers.reset();
  };
  return { texts, write, written, pass, end: () => end.abort(), close };
}

test("texts are written at the end of a drawing, ten times a second, and never between two of a flood", () => {
  const { texts, write, written, pass, close } = openTexts();
  for (let i = 0; i < 12; i++) {
    texts.ask(write);
    assert.ok(!written.includes(25 * i), "before the picture is painted");
    texts.write(false);
    pass(25);
  }
  assert.deepEqual(written, [0, 100, 200]);
  pass(1000);
  assert.equal(written.length, 4, "the last one is heard when the flood ends");
  close();
});

test("a drawing for another size writes at once, and after the end nothing is written", () => {
  const { texts, write, written, pass, end, close } = openTexts();
  for (const isNow of [false, true]) {
    texts.ask(write);
    texts.write(isNow);
  }
  assert.deepEqual(written, [0, 0]);
  texts.ask(write);
  end();
  pass(1000);
  assert.deepEqual(written, [0, 0]);
  close();
});
