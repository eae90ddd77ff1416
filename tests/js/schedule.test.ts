import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { afterDrawings, perAnimationFrame, Texts, throttle } from "../../robowidgets/js/shared/schedule.ts";

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

test("the first call passes at once, and so does one after a rest", () => {
  const { ask, calls, close } = open();
  ask();
  assert.deepEqual(calls, [1]);
  mock.timers.tick(100);
  ask();
  assert.deepEqual(calls, [1, 2]);
  close();
});

test("a flood passes ten times a second, including the last call", () => {
  const { ask, calls, close } = open();
  for (let i = 0; i < 100; i++) {
    ask();
    mock.timers.tick(10);
  }
  mock.timers.tick(100);
  assert.deepEqual(calls, [1, 10, 20, 30, 40, 50, 60, 70, 80, 90, 100]);
  close();
});

test("after the end calls are ignored", () => {
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

function openFrames() {
  mock.timers.enable({ apis: ["setTimeout"] });
  let now = 1000;
  const clock = mock.method(performance, "now", () => now);
  const asked: (() => void)[] = [];
  const errors: unknown[] = [];
  const fakes = {
    requestAnimationFrame: (call: () => void) => asked.push(call),
    reportError: (error: unknown) => errors.push(error),
  };
  const before = Object.fromEntries(Object.keys(fakes).map((name) => [name, globalThis[name as keyof typeof fakes]]));
  Object.assign(globalThis, fakes);
  const end = new AbortController();
  const drawn: string[] = [];
  /** A function that draws a card in some milliseconds, and asks for its text. */
  const card = (name: string, ms: number, isFirst = false) => {
    const draw = () => {
      drawn.push(name);
      now += ms;
      afterDrawings(() => drawn.push(`${name}'s text`));
    };
    return perAnimationFrame(draw, end.signal, isFirst);
  };
  const frame = () => {
    for (const call of asked.splice(0)) call();
    return drawn.splice(0);
  };
  /** Time in which the browser lays out and paints, and then handles other work. */
  const pass = (ms: number) => {
    now += ms;
    mock.timers.tick(ms);
  };
  const close = () => {
    end.abort();
    frame();
    mock.timers.reset();
    clock.mock.restore();
    Object.assign(globalThis, before);
  };
  return { card, frame, pass, asked, errors, signal: end.signal, close };
}

test("cards share a frame, the laser is drawn first, each once, and texts are written when all are painted", () => {
  const { card, frame, asked, close } = openFrames();
  const [map, laser] = [card("map", 1), card("laser", 1, true)];
  for (const ask of [map, laser, map, laser]) ask();
  assert.equal(asked.length, 1);
  assert.deepEqual(frame(), ["laser", "map", "laser's text", "map's text"]);
  assert.deepEqual(frame(), []);
  close();
});

test("the laser is in every frame, and the others in turn as long as there is time", () => {
  const { card, frame, close } = openFrames();
  const laser = card("laser", 5, true);
  const others = ["map", "plot", "events"].map((name) => card(name, 5));
  const frames = Array.from({ length: 3 }, () => {
    for (const ask of [...others, laser]) ask();
    return frame().filter((name) => !name.endsWith("text"));
  });
  assert.deepEqual(frames, [
    ["laser", "map"],
    ["laser", "plot"],
    ["laser", "events"],
  ]);
  assert.deepEqual(frame().slice(0, 1), ["map"], "what is left is drawn without being asked for again");
  close();
});

test("a frame of others that took long makes them rest as long, and the laser is drawn meanwhile", () => {
  const { card, frame, pass, close } = openFrames();
  const [map, laser] = [card("map", 2), card("laser", 1, true)];
  const frames = [30, 10, 10, 20, 1].map((ms) => {
    for (const ask of [map, laser]) ask();
    const names = frame().filter((name) => !name.endsWith("text"));
    pass(ms);
    return names.join();
  });
  assert.deepEqual(frames, ["laser,map", "laser", "laser", "laser", "laser,map"]);
  close();
});

test("an error of a card is reported, and does not stop the others", () => {
  const { card, frame, errors, signal, close } = openFrames();
  const broken = perAnimationFrame(
    () => {
      throw new Error("no");
    },
    signal,
    true,
  );
  for (const ask of [broken, card("map", 1)]) ask();
  assert.deepEqual(frame(), ["map", "map's text"]);
  assert.equal(String(errors), "Error: no");
  close();
});

test("a card that asks while it is drawn is drawn in the next frame, and one whose view has ended is not", () => {
  const { frame, signal, close } = openFrames();
  const [drawn, end] = [[] as number[], new AbortController()];
  const again = perAnimationFrame(() => drawn.push(drawn.length) < 2 && again(), signal, true);
  const gone = perAnimationFrame(() => assert.fail(), end.signal);
  for (const ask of [again, gone]) ask();
  end.abort();
  frame();
  assert.deepEqual(drawn, [0]);
  frame();
  assert.deepEqual(drawn, [0, 1]);
  close();
});
