import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { Prefetcher } from "../../robowidgets/js/player/prefetch.ts";
import { Segments } from "../../robowidgets/js/player/segments.ts";

/** A page that has the first two of many segments; its requests; and time that passes when the test calls for it. */
function start() {
  let now = 0;
  performance.now = () => now;
  mock.timers.reset();
  mock.timers.enable({ apis: ["setTimeout"] });
  const segments = new Segments(1);
  const asked: number[] = [];
  const controller = new AbortController();
  const prefetcher = new Prefetcher(segments, (time) => asked.push(time), controller.signal);
  const give = (index: number) => {
    segments.put(index, []);
    prefetcher.came();
  };
  give(0);
  give(1);
  const pass = (ms: number) => {
    now += ms;
    mock.timers.tick(ms);
  };
  return { prefetcher, segments, asked, give, pass, end: () => controller.abort() };
}

test("a resting pointer requests its segment once, and a passing one does not", () => {
  const { prefetcher, asked, give, pass } = start();
  for (const time of [3, 4, 5, 6]) {
    prefetcher.point(time);
    pass(16);
  }
  assert.deepEqual(asked, []);
  prefetcher.point(6.3);
  pass(16);
  assert.deepEqual(asked, [6]);
  for (let i = 0; i < 100; i++) {
    prefetcher.point(6 + (i % 10) / 10);
    pass(100);
  }
  give(6);
  pass(100);
  assert.deepEqual(asked, [6]);
});

test("a present segment is not requested, nor after the pointer has left, nor after the end", () => {
  const { prefetcher, asked, pass, end } = start();
  prefetcher.point(1.5);
  pass(100);
  prefetcher.point(7);
  prefetcher.point(null);
  pass(100);
  prefetcher.point(7);
  end();
  pass(100);
  assert.deepEqual(asked, []);
});

test("one request is pending at a time; the newest follows after its answer", () => {
  const { prefetcher, asked, give, pass } = start();
  prefetcher.ask(7.5);
  for (const time of [20, 30, 40]) {
    prefetcher.point(time);
    pass(50);
  }
  give(8);
  assert.deepEqual(asked, [7.5]);
  give(7);
  assert.deepEqual(asked, [7.5, 40]);
});

test("a place that the pointer has left is not requested after an answer", () => {
  const { prefetcher, asked, give, pass } = start();
  prefetcher.ask(7.5);
  prefetcher.point(20);
  pass(50);
  prefetcher.point(null);
  give(7);
  assert.deepEqual(asked, [7.5]);
});

test("a kernel that does not answer gets a request once a second at most", () => {
  const { prefetcher, asked, pass } = start();
  for (let time = 10; time < 110; time++) {
    prefetcher.point(time);
    pass(50);
  }
  assert.ok(asked.length >= 4 && asked.length <= 5, String(asked));
});
