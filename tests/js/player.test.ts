import assert from "node:assert/strict";
import { test } from "node:test";
import { actionOf, isBarsAlone, usesItself } from "../../robowidgets/js/player/keys.ts";
import type { Moved } from "../../robowidgets/js/player/moved.ts";
import { Playback } from "../../robowidgets/js/player/playback.ts";
import { decodeFrames, Segments } from "../../robowidgets/js/player/segments.ts";
import { toClock, toMinutes } from "../../robowidgets/js/shared/format.ts";
import { describeMark } from "../../robowidgets/js/shared/marks.ts";
import type { About } from "../../robowidgets/js/shared/traits.ts";
import { FakeModel } from "./models.ts";

/** Stills as Python packs them, amid the bytes of a larger message. */
function packed(...frames: [time: number, about: number, frame: number[]][]): DataView {
  const head = 8 * (1 + 3 * frames.length);
  const size = frames.reduce((sum, [, , frame]) => sum + frame.length, head);
  const view = new DataView(new ArrayBuffer(size + 9), 5, size);
  view.setFloat64(0, frames.length, true);
  let end = 0;
  for (const [i, [time, about, frame]] of frames.entries()) {
    for (const [j, byte] of frame.entries()) view.setUint8(head + end + j, byte);
    end += frame.length;
    for (const [j, value] of [time, about, end].entries()) view.setFloat64(8 * (1 + 3 * i + j), value, true);
  }
  return view;
}

const FRAME = [0, 0, 0, 0, 0, 0, 0, 0, 42];

function track(...times: number[]) {
  return {
    frames: decodeFrames(packed(...times.map((time): [number, number, number[]] => [time, 0, FRAME]))),
    abouts: [{ frame_id: "laser" }],
  };
}

test("decoded frames have their times, facts and separate bytes", () => {
  const frames = decodeFrames(packed([1, 0, [7, 8]], [1.5, 1, []], [1.75, 0, [9]]));
  assert.deepEqual(
    frames.map(({ time, about, bytes }) => [time, about, [...new Uint8Array(bytes.buffer)]]),
    [
      [1, 0, [7, 8]],
      [1.5, 1, []],
      [1.75, 0, [9]],
    ],
  );
});

test("the frame at a time is the last one up to that time", () => {
  const segments = new Segments(1);
  segments.put(3, [track(3, 3.2, 3.4)]);
  const at = (time: number) => segments.at(time)?.map(({ frame }) => frame.time);
  assert.deepEqual([at(3), at(3.19), at(3.2), at(3.99)], [[3], [3], [3.2], [3.4]]);
  assert.equal(at(2.99), undefined);
  segments.drop([3]);
  assert.equal(at(3.2), undefined);
});

test("steps go from frame to frame, past empty segments, and report a missing segment", () => {
  const segments = new Segments(1);
  segments.put(0, [track(0, 0.5)]);
  segments.put(1, [track(1)]);
  segments.put(2, [track(1)]);
  segments.put(3, [track(1, 3.25)]);
  assert.equal(segments.neighbour(0, 0, 1, 9), 0.5);
  assert.equal(segments.neighbour(0, 1, 1, 9), 3.25);
  assert.equal(segments.neighbour(0, 3.25, -1, 9), 1);
  assert.equal(segments.neighbour(0, 3.25, 1, 9), null);
  assert.equal(segments.neighbour(0, 0, -1, 9), 0);
  assert.equal(segments.neighbour(0, 3.25, 1, 3.5), 3.25);
});

test("steps go from message to message, past frames without a new one", () => {
  const abouts = [{}, { new: [] }, { new: ["commanded"] }];
  const framed = (...frames: [time: number, about: number][]) => ({
    frames: decodeFrames(packed(...frames.map(([time, about]): [number, number, number[]] => [time, about, FRAME]))),
    abouts,
  });
  const segments = new Segments(1);
  segments.put(0, [framed([0, 1], [0.1, 1], [0.25, 0], [0.35, 1])]);
  segments.put(1, [framed([1, 1], [1.1, 1])]);
  segments.put(2, [framed([2, 0], [2.1, 1], [2.5, 2])]);
  const walk = (time: number, direction: -1 | 1) => {
    const steps = [time];
    for (const from of steps) {
      const to = segments.neighbour(0, from, direction, 2.9);
      if (to !== null && to !== from) steps.push(to);
    }
    return steps.slice(1);
  };
  assert.deepEqual(walk(0, 1), [0.25, 2, 2.5]);
  assert.deepEqual(walk(2.9, -1), [2.5, 2, 0.25]);
});

test("the last frames up to a time come from several segments, each once, within the segments of the page", () => {
  const segments = new Segments(1);
  segments.put(1, [track(0.5, 1, 1.5)]);
  segments.put(2, [track(1.5)]);
  segments.put(3, [track(1.5, 3, 3.5)]);
  const upTo = (time: number, count: number) => segments.upTo(0, time, count).map(({ frame }) => frame.time);
  assert.deepEqual(upTo(3.2, 2), [1.5, 3]);
  assert.deepEqual(upTo(3.5, 9), [1, 1.5, 3, 3.5]);
  assert.deepEqual(upTo(0.2, 9), []);
});

interface Seen {
  on: Record<string, () => void>;
  state: Record<string, unknown>;
  host: Moved["targets"][number];
}

function host(): Seen {
  const seen: Seen = {
    on: {},
    state: { _about: {} },
    host: {
      get: (name: string) => seen.state[name] as never,
      set_state: (state) => Object.assign(seen.state, state),
      set: (name: string, value: unknown) => void Object.assign(seen.state, { [name]: value }),
      save_changes: () => {},
      on: ((event: string, callback: () => void) => Object.assign(seen.on, { [event]: callback })) as never,
      off: (event: string) => void delete seen.on[event],
    },
  };
  return seen;
}

/** A player with three segments of one widget, whose display shows a frame when the test says so. */
async function play(
  values: Record<string, unknown> = {},
  segments = [0, 1, 2],
  leads = { _shown: null, time: 0 } as object,
) {
  let now = 0;
  let frame: (() => void) | undefined;
  Object.assign(globalThis, {
    requestAnimationFrame: (call: () => void) => {
      frame = call;
      return 1;
    },
    cancelAnimationFrame: () => {
      frame = undefined;
    },
  });
  performance.now = () => now;
  const sent: unknown[] = [];
  const fake = new FakeModel({
    time: 0,
    duration: 3,
    playing: false,
    speed: 1,
    loop: false,
    selection: null,
    marks: [],
    labels: [],
    _segment: 1,
    _begin: 0,
    _first: [],
    _pauses: [],
    _leader: {},
    ...values,
  });
  const leader = new FakeModel({ ...leads });
  const get_model = async (id: string) => (id === "leader" ? leader : Promise.reject(new Error(id)));
  Object.assign(fake, { send: (content: unknown) => sent.push(content), widget_manager: { get_model } });
  const { state, host: target, on } = host();
  const controller = new AbortController();
  const follower = new FakeModel({ time: 0, selection: null });
  Object.assign(follower, { set_state: (state: Record<string, unknown>) => follower.receive(state) });
  const moved = { targets: [target], followers: [follower as unknown as Moved["followers"][number]] };
  const playback = new Playback(fake.model, async () => moved, controller.signal);
  await Promise.resolve();
  const give = (index: number) =>
    fake.tell({ segment: index, drop: [], abouts: [[{ frame_id: `${index}` }]] }, [
      packed([index, 0, FRAME], [index + 0.5, 0, FRAME]),
    ]);
  for (const index of segments) give(index);
  const pass = (ms: number) => {
    now += ms;
    const call = frame;
    frame = undefined;
    call?.();
  };
  return { fake, leader, follower, playback, state, on, sent, give, pass, end: () => controller.abort() };
}

test("an old frame has its age, also if it is new on show", async () => {
  const { fake, playback, state, end } = await play({ _pauses: [2], duration: 99 }, [0]);
  const frame = [...FRAME];
  for (const [index, time] of [
    [5, 0.5],
    [6, 0.5],
    [7, 7],
    [8, -1],
  ] as const) {
    fake.tell({ segment: index, drop: [], abouts: [[{ frame_id: "laser" }]] }, [packed([time, 0, frame])]);
  }
  const told = (time: number) => {
    playback.seek(time);
    return state._about;
  };
  assert.deepEqual(told(0.9), { frame_id: "0" });
  assert.deepEqual(told(5.04), { frame_id: "laser", age: 4500 });
  const shown = state._frame;
  assert.deepEqual(told(5.17), { frame_id: "laser", age: 4600 });
  assert.equal(state._frame, shown, "the same frame is not shown again");
  assert.deepEqual(told(6), { frame_id: "laser", age: 5500 });
  assert.deepEqual(told(7.9), { frame_id: "laser" });
  assert.deepEqual(told(8.5), { frame_id: "laser" }, "nothing was measured yet: it has no age");
  fake.receive({ _pauses: [0] });
  assert.deepEqual(told(5.04), { frame_id: "laser" }, "what holds until a message says otherwise is never old");
  end();
});

test("a widget that shows earlier samples gets those up to the one on show, and keeps them while it is frozen", async () => {
  const { fake, playback, state, on, give, end } = await play({}, [1, 2]);
  const recent = () => (state._recent as { bytes: DataView; about: unknown }[] | undefined)?.map(({ about }) => about);
  playback.seek(1.6);
  assert.equal(recent(), undefined, "it did not ask for any");
  const set = (values: Record<string, unknown>) => {
    Object.assign(state, values);
    for (const name of Object.keys(values)) on[`change:${name}`]?.();
  };
  set({ trail: 3 });
  assert.deepEqual(recent(), [{ frame_id: "1" }, { frame_id: "1" }]);
  assert.equal((state._recent as { bytes: DataView }[]).at(-1)?.bytes, state._frame);
  give(0);
  assert.equal(recent()?.length, 4, "frames of an earlier segment, which came later");
  set({ paused: true });
  playback.seek(2.6);
  assert.deepEqual(recent()?.at(-1), { frame_id: "1" });
  set({ paused: false });
  assert.deepEqual(recent()?.at(-1), { frame_id: "2" });
  state._needs = 1;
  set({ trail: 0 });
  assert.equal(recent()?.length, 2, "a view needs the one before");
  fake.tell({ segment: 2, drop: [], abouts: [[{ numbers: { r: 1 } }]] }, [packed([2, 0, FRAME], [2.5, 0, FRAME])]);
  assert.deepEqual(
    (state._recent as { at: number }[]).map(({ at }) => at),
    [0, 500, 1000, 1500, 2000, 2500],
    "numbers over time need all of them, with their times",
  );
  end();
});

test("a step into a missing segment is left to Python, and taken early if its segment arrives first", async () => {
  const { fake, playback, sent, give, end } = await play({ duration: 9 }, [0]);
  playback.seek(0.5);
  playback.step(1);
  assert.deepEqual(sent.at(-1), { step: [0.5, 1] });
  give(3);
  assert.deepEqual([playback.time, playback.waits], [0.5, true], "a segment between is missing still");
  give(1);
  assert.deepEqual([playback.time, playback.waits], [1, false]);
  fake.tell({ seek: 1, step: [0.5, 1] });
  playback.seek(1.5);
  fake.tell({ seek: 1, step: [0.5, 1] });
  assert.equal(playback.time, 1.5, "its answer comes too late");
  playback.step(1);
  fake.tell({ seek: 7.25, step: [1.5, 1] });
  assert.deepEqual([playback.time, sent.at(-1)], [7.25, { pointed: 7.25 }]);
  end();
});

test("the newest of several steps is taken, and none after a seek or once it plays", async () => {
  const { fake, playback, give, end } = await play({ duration: 9, time: 5.5 }, [5]);
  playback.step(1);
  playback.step(-1);
  playback.step(-1);
  fake.tell({ seek: 6, step: [5.5, 1] });
  assert.equal(playback.time, 5);
  give(6);
  assert.equal(playback.time, 5);
  give(4);
  assert.equal(playback.time, 4.5);
  for (const other of [() => playback.seek(6), () => fake.receive({ time: 6 }), () => playback.toggle()]) {
    playback.seek(6.5);
    playback.step(1);
    assert.ok(playback.waits);
    other();
    assert.ok(!playback.waits);
  }
  fake.receive({ playing: false });
  const before = playback.time;
  give(7);
  assert.equal(playback.time, before);
  end();
});

test("a page without segments reports it, and shows new ones without a message to the kernel", async () => {
  const { fake, state, sent, end } = await play();
  assert.deepEqual(sent, [{ have: "nothing" }]);
  assert.deepEqual(state._about, { frame_id: "0" });
  assert.equal((state._frame as DataView).getUint8(8), 42);
  assert.deepEqual(fake.saved, []);
  end();
});

test("Python is notified of a missing moment at once, and of other times now and then", async () => {
  const { fake, playback, sent, give, end } = await play({ duration: 9 });
  for (const time of [0.5, 1, 7.2, 1.5, 8.4]) playback.seek(time);
  assert.deepEqual(
    fake.saved.map(({ time }) => time),
    [0.5, 7.2, 8.4],
  );
  assert.deepEqual(sent.slice(1), [{ pointed: 7.2 }]);
  give(7);
  assert.deepEqual(sent.slice(1), [{ pointed: 7.2 }, { pointed: 8.4 }]);
  end();
});

test("it plays at its speed, numbers the frames on, and stops at the end", async () => {
  const { fake, playback, state, pass, end } = await play({ speed: 2 });
  playback.toggle();
  for (let i = 0; i < 11; i++) pass(100);
  assert.ok(Math.abs(playback.time - 2.2) < 1e-9);
  assert.deepEqual(state._about, { frame_id: "2" });
  assert.equal((state._frame as DataView).getFloat64(0, true), 5);
  for (let i = 0; i < 10; i++) pass(100);
  assert.equal(playback.time, 3);
  assert.equal(fake.get("playing"), false);
  playback.toggle();
  assert.equal(playback.time, 0);
  end();
});

test("playing waits for a missing segment instead of skipping it", async () => {
  const { playback, pass, give, end } = await play({ playing: true }, [0]);
  for (let i = 0; i < 30; i++) pass(100);
  assert.ok(playback.waits && playback.time < 1.2, String(playback.time));
  give(1);
  assert.ok(!playback.waits);
  end();
});

test("looped, the selection begins again at its end", async () => {
  const { playback, pass, end } = await play({ playing: true, loop: true, selection: [1, 2], time: 1.8 });
  for (let i = 0; i < 3; i++) pass(100);
  assert.ok(playback.time < 1.2 && playback.time >= 1, String(playback.time));
  end();
});

test("a time that Python sets is shown, and the time of another playing page is not a seek", async () => {
  const { fake, playback, state, end } = await play();
  fake.receive({ time: 2.5 });
  assert.equal(playback.time, 2.5);
  assert.deepEqual(state._about, { frame_id: "2" });
  fake.receive({ playing: true });
  fake.receive({ time: 2.6 });
  assert.equal(playback.time, 2.5);
  fake.receive({ time: 0.5 });
  assert.equal(playback.time, 0.5);
  end();
});

test("a seek of a program while it plays is carried out, and replaced data are shown", async () => {
  const { fake, playback, state, give, end } = await play({ playing: true });
  fake.tell({ seek: 0.6 });
  assert.equal(playback.time, 0.6);
  const before = state._frame;
  give(0);
  assert.notEqual(state._frame, before);
  end();
});

test("a loop that ends after the recording ends with it", async () => {
  const { playback, pass, end } = await play({ playing: true, loop: true, selection: [1, 1e6], time: 2.9 });
  for (let i = 0; i < 3; i++) pass(100);
  assert.ok(playback.time >= 1 && playback.time < 1.5, String(playback.time));
  end();
});

test("keys step, jump, go from mark to mark and change the speed", async () => {
  const { fake, playback, end } = await play({
    marks: [
      [0.25, 0.5, "bump"],
      [2, 2.5, "bump"],
    ],
  });
  const press = (key: string, shift = false) => actionOf(key, shift)?.(playback, fake.model);
  const times = [".", ".", ",", "ArrowRight", "ArrowLeft", "n", "n", "p", "End", "Home"].map((key) => {
    press(key);
    return playback.time;
  });
  assert.deepEqual(times, [0.5, 1, 0.5, 1.5, 0.5, 2, 2, 0.25, 3, 0]);
  press("ArrowRight", true);
  assert.equal(playback.time, 3);
  press("+");
  assert.equal(fake.get("speed"), 2);
  press("-");
  press("-");
  assert.equal(fake.get("speed"), 0.5);
  press("l");
  assert.equal(fake.get("loop"), true);
  assert.equal(actionOf("x", false), undefined);
  end();
});

test("the time under the pointer on another widget is requested within the recording, and shown at once on a click", async (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  const { follower, playback, state, sent, give, end } = await play({ duration: 9 });
  for (const pointed of [7.2, 1.5, 8.4, null, 12]) {
    follower.set("_pointed", pointed === null ? null : { time: pointed, ray: null });
    t.mock.timers.tick(pointed === 8.4 ? 10 : 50);
    if (pointed === 7.2) give(7);
  }
  assert.deepEqual(sent.slice(1), [{ pointed: 7.2 }, { pointed: 9 }]);
  assert.equal(playback.time, 0);
  follower.set("time", 7.2);
  assert.ok(!playback.waits);
  assert.deepEqual(state._about, { frame_id: "7" });
  end();
});

test("every widget shows the moment and the ray under the pointer until the pointer leaves", async () => {
  const { fake, follower, playback, state, pass, end } = await play({}, [0, 2]);
  const shows = () => [(state._about as { frame_id: string }).frame_id, state.hovered ?? null, playback.shown];
  follower.set("_pointed", { time: 2.75, ray: 4 });
  assert.deepEqual(shows(), ["2", 4, 2.75]);
  assert.deepEqual([playback.time, follower.get("time"), fake.get("time")], [0, 0, 0], "the time stays");
  follower.set("_pointed", { time: 1.5, ray: 5 });
  assert.deepEqual(shows(), ["2", null, 1.5], "what the page lacks is not mixed with a ray of another moment");
  assert.equal((state._about as About).waits, true, "nor passed for that moment");
  follower.set("_pointed", { time: 2.5, ray: null });
  assert.deepEqual(shows(), ["2", null, 2.5]);
  follower.set("_pointed", null);
  assert.deepEqual(shows(), ["0", null, 0]);
  follower.set("_pointed", { time: 2.5, ray: 4 });
  follower.set("time", 2.5);
  follower.set("_pointed", null);
  assert.deepEqual([shows(), playback.time], [["2", null, 2.5], 2.5], "a click keeps it");
  follower.set("_pointed", { time: 0.25, ray: null });
  playback.step(-1);
  assert.equal(playback.shown, 2, "a step is shown though the pointer rests");
  playback.toggle();
  follower.set("_pointed", { time: 0.5, ray: null });
  pass(100);
  assert.equal(playback.shown, playback.time, "playing goes on under the pointer");
  end();
});

test("widgets say that they wait while the page lacks the moment on show, and go on with it", async () => {
  const { playback, state, give, end } = await play({ duration: 99 }, [0]);
  const about = () => state._about as About;
  playback.seek(0.5);
  assert.equal(about().waits, undefined);
  playback.seek(40.2);
  assert.deepEqual([about().waits, about().frame_id, playback.shown], [true, "0", 40.2]);
  playback.seek(0.5);
  assert.equal(about().waits, undefined, "back where the same frame is right");
  playback.seek(50.2);
  give(40);
  assert.equal(about().waits, true, "what comes too late is of another moment, too");
  give(50);
  assert.deepEqual([about().waits, about().frame_id], [undefined, "50"]);
  end();
});

test("a picture from before the page has any segment is not marked as of another moment", async () => {
  const { state, end } = await play({ time: 2 }, []);
  assert.deepEqual(state._about, {});
  end();
});

test("times are in minutes from a minute on, rounded once, and as wide as the longest", () => {
  assert.deepEqual(
    [0, 59.994, 60, 725.3, 3599.999].map((seconds) => toMinutes(seconds, 2)),
    ["0.00", "59.99", "1:00.00", "12:05.30", "60:00.00"],
  );
  assert.deepEqual(
    [0, 5.2, 59.999, 61].map((seconds) => toMinutes(seconds, 2, 725)),
    ["0:00.00", "0:05.20", "1:00.00", "1:01.00"],
  );
  assert.deepEqual(
    [toMinutes(3725.25, 2), toMinutes(65, 2, 7200), toMinutes(65.4, 0)],
    ["1:02:05.25", "0:01:05.00", "1:05"],
  );
});

test("a step moves frozen widgets from the moment at which they are frozen, and they stay frozen", async () => {
  const { fake, playback, state, on, sent, give, end } = await play({ time: 1.5 }, [0, 1]);
  const freeze = (paused: boolean) => {
    state.paused = paused;
    on["change:paused"]?.();
  };
  const held = () => (state._frozen_frame as DataView | undefined)?.getUint8(8);
  freeze(true);
  playback.seek(0.5);
  assert.deepEqual([held(), playback.time], [undefined, 0.5], "what only seeks leaves them");
  playback.step(-1);
  assert.deepEqual([held(), playback.time, state._frozen_frame === state._frame], [42, 1, true]);
  playback.step(1);
  playback.step(1);
  assert.deepEqual(sent.at(-1), { step: [1.5, 1] }, "where the page lacks the next sample Python finds it");
  const before = state._frozen_frame;
  give(0);
  assert.equal(state._frozen_frame, before, "whatever else comes first");
  fake.tell({ seek: 2.5, step: [1.5, 1] });
  assert.equal(state._frozen_frame, before, "until its segment is there");
  give(2);
  assert.notEqual(state._frozen_frame, before);
  assert.equal(state._frozen_frame, state._frame);
  freeze(false);
  playback.step(-1);
  assert.deepEqual([playback.time, state._frozen_frame === state._frame], [2, false]);
  end();
});

test("another widget shows the time, is followed at clicks of the user, and released at the end", async () => {
  const { fake, follower, playback, state, pass, end } = await play();
  playback.toggle();
  for (let i = 0; i < 3; i++) pass(100);
  assert.equal(follower.get("time"), playback.time);
  follower.set("time", 2.5);
  assert.equal(playback.time, 2.5);
  assert.deepEqual(state._about, { frame_id: "2" });
  follower.set("selection", [1, 2, 30, 40]);
  await Promise.resolve();
  assert.deepEqual(fake.get("selection"), [1, 2]);
  follower.set("selection", null);
  await Promise.resolve();
  assert.equal(fake.get("selection"), null);
  const [own, others] = [fake.saved.length, follower.saved.length];
  fake.set("selection", [0, 2]);
  assert.deepEqual(follower.get("selection"), [0, 2]);
  assert.deepEqual([fake.saved.length, follower.saved.length], [own, others + 1], "and Python gets it first");
  Object.assign(fake, { _state_lock: { selection: [1, 2] } });
  fake.receive({ selection: [1, 2] });
  assert.deepEqual(follower.get("selection"), [0, 2], "Python gives its own change to both");
  end();
  assert.equal(follower.listening, 0);
  assert.equal(fake.listening, 0);
});

test("messages of the kernel about another widget move nothing: they may be old, or a click in another page", async () => {
  const { fake, follower, playback, sent, end } = await play();
  const send = (time: number) => {
    Object.assign(follower, { _state_lock: { time } });
    follower.receive({ time });
    Object.assign(follower, { _state_lock: null });
  };
  playback.seek(2);
  send(0);
  assert.deepEqual([playback.time, follower.get("time"), fake.get("time")], [2, 2, 2]);
  follower.set("time", 0.5);
  playback.step(1);
  const [saves, messages] = [fake.saved.length, sent.length];
  for (const time of [0.5, 2.5]) {
    send(time);
    assert.deepEqual([playback.time, follower.get("time")], [1, 1]);
  }
  assert.deepEqual([fake.saved.length, sent.length], [saves, messages], "and tells Python nothing");
  fake.receive({ time: 2.5 });
  assert.deepEqual([playback.time, follower.get("time")], [2.5, 2.5], "the time of the player does");
  follower.set("time", 0.5);
  assert.equal(playback.time, 0.5, "and a click here");
  end();
});

test("widgets that get an old state from the kernel show the player's moment", async () => {
  const { playback, follower, state, on, end } = await play();
  playback.seek(1);
  follower.set("_pointed", { time: 2, ray: 7 });
  const frame = state._frame;
  Object.assign(state, { _frame: new DataView(new ArrayBuffer(9)), _about: { frame_id: "long ago" }, hovered: null });
  on["change:_frame"]?.();
  on["change:_about"]?.();
  await Promise.resolve();
  assert.deepEqual([state._frame, state._about, state.hovered], [frame, { frame_id: "2" }, 7]);
  end();
});

test("a page that draws seldom does not play ahead of another one", async () => {
  const { fake, playback, pass, end } = await play({ duration: 99 }, [0, 1, 2, 3, 4]);
  playback.toggle();
  pass(0);
  pass(1000);
  assert.equal(playback.time, 1);
  pass(0);
  const { now } = performance;
  const later = now() + 2000;
  performance.now = () => later;
  fake.receive({ time: 3 });
  performance.now = now;
  pass(2100);
  assert.equal(Math.round(1000 * playback.time), 3100);
  end();
});

test("a moment has a date and a time of day in UTC, of its last full second", () => {
  assert.deepEqual(toClock(1_714_746_725), ["2024-05-03", "14:32:05"]);
  assert.deepEqual(toClock(1_714_746_725.994), ["2024-05-03", "14:32:05"]);
  assert.deepEqual(toClock(1_714_694_400 - 0.5), ["2024-05-02", "23:59:59"]);
  // Rounding of a float does not make a whole second one less.
  assert.deepEqual(toClock(1_700_000_000.1 + 5.9), ["2023-11-14", "22:13:26"]);
});

test("arrows up and down move the page, unless the bar has the focus", () => {
  assert.deepEqual(["ArrowUp", "ArrowDown", "ArrowLeft", " ", ",", "Home"].filter(isBarsAlone), [
    "ArrowUp",
    "ArrowDown",
  ]);
});

test("a text field or a list in focus gets every key, and a button the space bar", () => {
  const focused = (kind: string, isContentEditable = false) =>
    ({
      isContentEditable,
      matches: (kinds: string) => kinds.split(", ").includes(kind),
    }) as HTMLElement;
  const used = (element: HTMLElement) => [" ", "l", "."].filter((key) => usesItself(element, key));
  assert.deepEqual(used(focused("select")), [" ", "l", "."]);
  assert.deepEqual(used(focused("textarea")), [" ", "l", "."]);
  assert.deepEqual(used(focused("div", true)), [" ", "l", "."]);
  assert.deepEqual(used(focused("button")), [" "]);
  assert.deepEqual(used(focused("div")), []);
});

test("the text has the number of the mark at or before a time, and the number of marks", () => {
  const marks: [number, number, string][] = [
    [1, 2, "bump"],
    [5, 5, ""],
  ];
  const said = [0.5, 1, 1.5, 4.996, 9].map((time) => Object.values(describeMark(marks, time)));
  const [first, second] = [
    ["mark 1 of 2", "bump"],
    ["mark 2 of 2", ""],
  ];
  assert.deepEqual(said, [["2 marks", ""], first, first, second, second]);
  assert.equal(describeMark([[1, 2, "x"]], 0).number, "1 mark");
});

test("a player follows another to the same place, stays without such a place, and shows it", async () => {
  const floats = (...values: number[]) => new DataView(new Float64Array(values).buffer);
  const _leader = { model: "leader", times: floats(1, 2, 3), seconds: floats(0.5, NaN, 2.5), lost: "no place there" };
  const { fake, leader, playback, end } = await play({ _leader });
  const at = (_shown: number) => {
    leader.receive({ _shown });
    return [playback.time, playback.lost];
  };
  assert.deepEqual(at(0.9), [0, "no place there"], "it has no pose before the first");
  assert.deepEqual(at(1), [0.5, ""]);
  assert.deepEqual(at(2.9), [0.5, "no place there"]);
  assert.deepEqual(at(9), [2.5, ""]);
  assert.deepEqual(fake.saved.at(0)?.time, 0.5, "Python gets the time");
  playback.seek(1);
  assert.deepEqual([playback.time, playback.lost], [1, ""], "it can be moved by itself");
  const again = await play({ _leader, time: 1 }, [0, 1, 2], { _shown: 9, time: 9 });
  assert.deepEqual([again.playback.time, again.playback.lost], [1, ""], "also in a page that is loaded anew");
  Object.assign(again.leader, { _state_lock: { time: 1 } });
  again.leader.receive({ _shown: 1 });
  assert.deepEqual([again.playback.time, again.fake.saved], [0.5, []], "the page that moves the leader tells Python");
  Object.assign(again.leader, { _state_lock: null });
  again.leader.receive({ _shown: 3 });
  assert.deepEqual([again.playback.time, again.fake.saved], [2.5, [{ _shown: 2.5, time: 2.5 }]]);
  again.end();
  fake.receive({ _leader: { ..._leader, seconds: floats(0.25, 0.5, 0.75) } });
  await Promise.resolve();
  await Promise.resolve();
  assert.equal(playback.time, 0.75, "it goes where the new one is");
  fake.receive({ _leader: { ..._leader, model: "closed" } });
  await Promise.resolve();
  assert.deepEqual(at(1), [0.75, ""]);
  fake.receive({ _leader: { ..._leader } });
  await Promise.resolve();
  await Promise.resolve();
  assert.deepEqual(at(2), [0.5, "no place there"]);
  const said: string[] = [];
  playback.listen(() => said.push(playback.lost), new AbortController().signal);
  fake.receive({ _leader: {} });
  assert.deepEqual(said, [""], "the bar takes it back");
  assert.deepEqual(at(1), [0.5, ""]);
  end();
  assert.equal(leader.listening, 0);
});

test("a player passes the moment on show on to its followers", async () => {
  const { fake, playback, state, on, end } = await play();
  const shown = () => fake.get("_shown");
  playback.seek(1.25);
  assert.equal(shown(), 1.25);
  playback.preview({ time: 2.25, ray: null });
  assert.equal(shown(), 2.25);
  playback.preview(null);
  assert.equal(shown(), 1.25);
  state.paused = true;
  on["change:paused"]?.();
  playback.seek(2);
  assert.equal(shown(), 1.25, "they are frozen there");
  end();
});

test("a message for another part of the page leaves the segments as they are", async () => {
  const { fake, playback, state, end } = await play();
  playback.seek(1.2);
  fake.tell({ labelled: [] });
  playback.seek(0.5);
  assert.deepEqual(state._about, { frame_id: "0" });
  end();
});
