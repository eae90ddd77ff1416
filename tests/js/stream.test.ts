import assert from "node:assert/strict";
import { test } from "node:test";
import { Reader } from "../../robowidgets/js/shared/bytes.ts";
import { type Frame, readHead, Stream } from "../../robowidgets/js/shared/stream.ts";
import { FakeModel } from "./models.ts";

const OFFSET = 5;
const HEAD = 32;

/** A frame with nothing but a head, amid the bytes of a larger message. */
function frame(sequence: number, rate = 40): DataView {
  const bytes = new DataView(new ArrayBuffer(OFFSET + HEAD + 3), OFFSET, HEAD);
  bytes.setFloat64(0, sequence, true);
  bytes.setFloat64(8, rate, true);
  return bytes;
}

function open(values: Record<string, unknown> = {}) {
  const fake = new FakeModel({
    paused: false,
    _frozen_frame: new DataView(new ArrayBuffer(0)),
    _about: {},
    _source: {},
    ...values,
  });
  const controller = new AbortController();
  let decoded = 0;
  const decode = (bytes: DataView): Frame => {
    decoded++;
    return readHead(new Reader(bytes));
  };
  const stream = new Stream(fake.model, decode, controller.signal);
  return { fake, stream, end: () => controller.abort(), signal: controller.signal, decodings: () => decoded };
}

test("nothing is shown before the first frame", () => {
  const { stream, end } = open();
  assert.equal(stream.shown, null);
  assert.equal(stream.since, 0);
  assert.equal(stream.live, false);
  end();
});

test("a new view shows the state of its model", () => {
  const { stream, end } = open({ _frame: frame(7) });
  assert.deepEqual(stream.shown, { sequence: 7, rate: 40, arrived: 0 });
  end();
});

test("the newest frame is shown, and decoded once", () => {
  const { fake, stream, end, decodings } = open();
  for (let i = 1; i <= 5; i++) fake.receive({ _frame: frame(i) });
  assert.equal(decodings(), 0);
  assert.equal(stream.shown?.sequence, 5);
  assert.equal(stream.shown, stream.shown);
  assert.equal(decodings(), 1);
  end();
});

test("a freeze by the user holds the picture here and notifies Python, with exactly the frame's bytes", () => {
  const { fake, stream, end } = open({ _frame: frame(3) });
  stream.toggle();
  fake.receive({ _frame: frame(10) });
  assert.equal(stream.paused, true);
  assert.equal(stream.shown?.sequence, 3);
  assert.equal(stream.since, 7);
  const [message] = fake.saved;
  assert.deepEqual(Object.keys(message ?? {}).sort(), ["_frozen_frame", "paused"]);
  const held = message?._frozen_frame as DataView;
  // Hosts send the whole buffer under a view, so it must contain nothing else.
  assert.equal(held.buffer.byteLength, HEAD);
  assert.equal(held.getFloat64(0, true), 3);
  end();
});

test("released, the newest shows at once, and no frame is held", () => {
  const { fake, stream, end } = open({ _frame: frame(3) });
  stream.toggle();
  fake.receive({ _frame: frame(10) });
  stream.toggle();
  assert.equal(stream.paused, false);
  assert.equal(stream.shown?.sequence, 10);
  assert.equal(stream.since, 0);
  assert.equal((fake.saved[1] as { _frozen_frame: DataView })._frozen_frame.byteLength, 0);
  assert.equal(fake.saved[1]?.paused, false);
  end();
});

test("a freeze by Python holds the present frame until Python sends the frozen one", () => {
  const { fake, stream, end } = open({ _frame: frame(3) });
  fake.receive({ paused: true });
  fake.receive({ _frame: frame(4) });
  assert.equal(stream.shown?.sequence, 3);
  fake.receive({ _frozen_frame: frame(4) });
  fake.receive({ _frame: frame(9) });
  assert.equal(stream.shown?.sequence, 4);
  assert.equal(stream.since, 5);
  fake.receive({ paused: false });
  assert.equal(stream.shown?.sequence, 9);
  fake.receive({ _frozen_frame: new DataView(new ArrayBuffer(0)) });
  fake.receive({ paused: true });
  assert.equal(stream.shown?.sequence, 9);
  end();
});

test("a reload while frozen finds the frozen picture and the count", () => {
  const { stream, end } = open({ paused: true, _frozen_frame: frame(3), _frame: frame(8) });
  assert.equal(stream.shown?.sequence, 3);
  assert.equal(stream.since, 5);
  end();
});

test("frozen before the first frame, the picture is empty and all frames are counted", () => {
  const { fake, stream, end } = open();
  stream.toggle();
  fake.receive({ _frame: frame(4) });
  assert.equal(stream.shown?.sequence, undefined);
  stream.toggle();
  assert.equal(stream.shown?.sequence, 4);
  end();
});

test("a kernel that restarts its count does not make a negative count", () => {
  const { fake, stream, end } = open({ paused: true, _frozen_frame: frame(100), _frame: frame(100) });
  fake.receive({ _frame: frame(2) });
  assert.equal(stream.since, 0);
  end();
});

test("a fast source is live for a second after a frame, and says when that ends", (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  const { fake, stream, end, signal } = open();
  let told = 0;
  stream.listen(() => told++, signal);
  fake.receive({ _frame: frame(1) });
  assert.equal(stream.live, true);
  t.mock.timers.tick(999);
  fake.receive({ _frame: frame(2) });
  t.mock.timers.tick(999);
  assert.equal(stream.live, true);
  assert.equal(told, 2);
  t.mock.timers.tick(1);
  assert.equal(stream.live, false);
  assert.equal(told, 3);
  end();
});

test("views are notified of every change until their signal ends, and the model has no listeners at the end", () => {
  const { fake, stream, end } = open();
  const [first, second] = [new AbortController(), new AbortController()];
  const heard = { first: 0, second: 0 };
  stream.listen(() => heard.first++, first.signal);
  stream.listen(() => heard.second++, second.signal);
  fake.receive({ _frame: frame(1) });
  fake.receive({ _about: { error: "too long" } });
  assert.deepEqual(heard, { first: 2, second: 2 });
  first.abort();
  fake.receive({ paused: true });
  fake.receive({ _frozen_frame: frame(1) });
  assert.deepEqual(heard, { first: 2, second: 4 });
  end();
  assert.equal(fake.listening, 0);
  fake.receive({ _frame: frame(2) });
  assert.deepEqual(heard, { first: 2, second: 4 });
});

function sequences(stream: Stream<Frame>, by: number, count: number): (number | undefined)[] {
  return Array.from({ length: count }, () => {
    stream.step(by);
    return stream.shown?.sequence;
  });
}

test("frozen, it steps back and forth through the samples, and stops at the ends", (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  const { fake, stream, end } = open({ history: 30 });
  for (let i = 1; i <= 4; i++) fake.receive({ _frame: frame(i) });
  assert.deepEqual(sequences(stream, -1, 1), [4]);
  stream.toggle();
  assert.deepEqual(stream.place, { index: 3, count: 4, behind: 0 });
  assert.equal(stream.stepped, false);
  assert.deepEqual(sequences(stream, -1, 5), [3, 2, 1, 1, 1]);
  assert.equal(stream.stepped, true);
  assert.equal(stream.place?.index, 0);
  assert.ok((stream.place?.behind ?? -1) >= 0);
  assert.equal(stream.since, 3);
  fake.receive({ _frame: frame(5) });
  assert.deepEqual(sequences(stream, 1, 5), [2, 3, 4, 5, 5]);
  stream.seek(1);
  assert.equal(stream.shown?.sequence, 2);
  stream.toggle();
  assert.equal(stream.shown?.sequence, 5);
  assert.equal(stream.place, null);
  end();
});

test("steps are sent to Python ten times a second, with exactly the frame's bytes", (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  const { fake, stream, end } = open({ history: 30 });
  for (let i = 1; i <= 50; i++) fake.receive({ _frame: frame(i) });
  stream.toggle();
  const before = fake.saved.length;
  for (let i = 0; i < 40; i++) {
    stream.step(-1);
    t.mock.timers.tick(10);
  }
  t.mock.timers.tick(100);
  const told = fake.saved.slice(before).map(({ _frozen_frame }) => _frozen_frame as DataView);
  assert.equal(told.length, 5);
  assert.equal(told.at(-1)?.getFloat64(0, true), 10);
  assert.equal(told.at(-1)?.buffer.byteLength, HEAD);
  end();
});

test("without a history, or with one sample, there are no steps", () => {
  for (const history of [0, 30]) {
    const { fake, stream, end } = open({ history });
    for (let i = 1; i <= (history ? 1 : 3); i++) fake.receive({ _frame: frame(i) });
    stream.toggle();
    if (!history) fake.receive({ _frame: frame(9) });
    assert.equal(stream.place, null);
    stream.step(-1);
    assert.equal(stream.shown?.sequence, history ? 1 : 3);
    end();
  }
});

test("a reload keeps the sample that was stepped to, at an unknown time", () => {
  const { fake, stream, end } = open({ history: 30, paused: true, _frozen_frame: frame(3), _frame: frame(8) });
  assert.deepEqual(stream.place, { index: 0, count: 2, behind: Number.NaN });
  fake.receive({ _frame: frame(9) });
  assert.deepEqual(sequences(stream, 1, 3), [8, 9, 9]);
  assert.deepEqual(sequences(stream, -1, 3), [8, 3, 3]);
  end();
});

test("a frame that Python holds is found among the samples of the page", () => {
  const { fake, stream, end } = open({ history: 30 });
  for (let i = 1; i <= 5; i++) fake.receive({ _frame: frame(i) });
  fake.receive({ _frozen_frame: frame(4), paused: true });
  assert.equal(stream.place?.index, 3);
  assert.deepEqual(sequences(stream, -1, 1), [3]);
  end();
});

test("silence begins three periods after the last frame, from one second to ten", (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  const { fake, stream, end } = open();
  const limits: [number, number][] = [
    [40, 1000],
    [2, 1500],
    [0.5, 6000],
    [0.2, 10_000],
    [0.01, 10_000],
    [1e-9, 10_000],
  ];
  for (const [i, [rate, limit]] of limits.entries()) {
    fake.receive({ _frame: frame(i + 1, rate) });
    assert.equal(stream.rate, rate);
    t.mock.timers.tick(limit - 1);
    assert.equal(stream.silence, 0);
    t.mock.timers.tick(1);
    assert.ok(stream.silence > 0);
  }
  end();
});

test("a frame that adds to the same sample does not end a silence: a command, the end of a touch", (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  const again = () => fake.receive({ _frame: frame(2) });
  const { fake, stream, end } = open({ _frame: frame(1), _silence: 0.5 });
  fake.receive({ _frame: frame(1) });
  t.mock.timers.tick(500);
  assert.ok(stream.silence > 0, "also when the page found the sample");
  again();
  assert.equal(stream.silence, 0);
  t.mock.timers.tick(900);
  again();
  t.mock.timers.tick(100);
  assert.equal(stream.live, false);
  const before = stream.arrived;
  again();
  assert.equal(stream.live, false);
  assert.ok(stream.arrived > before, "what it says is of now");
  const restarted = frame(2);
  restarted.setFloat64(24, 7, true);
  fake.receive({ _frame: restarted });
  assert.equal(stream.live, true, "a kernel that restarts its count");
  end();
});

test("without a rate only a feed can be silent, after ten seconds", (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  for (const topic of [undefined, "/scan"]) {
    const { fake, stream, end } = open({ _source: { topic } });
    fake.receive({ _frame: frame(1, Number.NaN) });
    t.mock.timers.tick(9999);
    assert.equal(stream.silence, 0);
    t.mock.timers.tick(1);
    assert.equal(stream.silence > 0, topic !== undefined);
    end();
  }
});

test("a page that is loaded counts from the arrival of the frame in Python, and saves no age", async (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  const { fake, stream, end } = open({ _frame: frame(7), _silence: 60 });
  await Promise.resolve();
  t.mock.timers.tick(0);
  assert.ok(stream.silence >= 60_000);
  assert.equal(stream.arrived, 0);
  assert.equal(fake.model.get("_silence"), 0);
  fake.receive({ _frame: frame(8) });
  assert.equal(stream.silence, 0);
  end();
});

test("a page that connects again counts from the arrival of the frame in Python, too", async (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  // Buffers are set last.
  for (const state of [{ _silence: 60 }, { _silence: 60, _frame: frame(8) }, { _frame: frame(8), _silence: 60 }]) {
    const { fake, stream, end } = open({ _frame: frame(6) });
    fake.receive({ _frame: frame(7) });
    fake.receive(state);
    await Promise.resolve();
    t.mock.timers.tick(0);
    assert.ok(stream.silence >= 60_000);
    assert.equal(fake.model.get("_silence"), 0);
    fake.receive({ _frame: frame(9) });
    assert.equal(stream.silence, 0);
    end();
  }
});

test("a page that is loaded between two frames shows a live source", (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  const { stream, end } = open({ _frame: frame(7), _silence: 0.4 });
  t.mock.timers.tick(599);
  assert.equal(stream.silence, 0);
  t.mock.timers.tick(1);
  assert.ok(stream.silence >= 400);
  end();
});

test("a picture without an age from Python is not silent: an export, or one filled by hand", (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  for (const _silence of [undefined, 0]) {
    const { stream, end } = open({ _frame: frame(7), _silence });
    t.mock.timers.tick(60_000);
    assert.equal(stream.silence, 0);
    end();
  }
});

test("the facts about a frozen sample are the ones of its arrival", () => {
  const { fake, stream, end } = open({ history: 30 });
  fake.receive({ _frame: frame(1), _about: { frame_id: "front" } });
  fake.receive({ _frame: frame(2), _about: { frame_id: "rear" } });
  assert.equal(stream.about.frame_id, "rear");
  stream.toggle();
  fake.receive({ _frame: frame(3), _about: { frame_id: "front" } });
  assert.equal(stream.about.frame_id, "rear");
  stream.step(-1);
  assert.equal(stream.about.frame_id, "front");
  stream.step(1);
  assert.equal(stream.about.frame_id, "rear");
  stream.toggle();
  assert.equal(stream.about.frame_id, "front");
  end();
});

test("later facts about the newest sample stay with it, and with no other", () => {
  const { fake, stream, end } = open({ history: 30 });
  fake.receive({ _about: { frame_id: "a" }, _frame: frame(1) });
  fake.receive({ _about: { frame_id: "a, later" } });
  fake.receive({ _about: { frame_id: "b" }, _frame: frame(2) });
  stream.toggle();
  assert.equal(stream.about.frame_id, "b");
  fake.receive({ _about: { frame_id: "c" }, _frame: frame(3) });
  assert.equal(stream.about.frame_id, "b");
  stream.step(-1);
  assert.equal(stream.about.frame_id, "a, later");
  end();
});

test("without a history, too, the facts about a frozen sample stay with it, also after a player stepped to it", () => {
  const { fake, stream, end } = open({ history: 0 });
  const said = () => [stream.about.frame_id, stream.last(9).at(-1)?.about.frame_id];
  fake.receive({ _about: { frame_id: "front" }, _frame: frame(1) });
  stream.toggle();
  fake.receive({ _about: { frame_id: "front, later" } });
  for (const i of [2, 3]) fake.receive({ _about: { frame_id: "rear" }, _frame: frame(i) });
  assert.deepEqual(said(), ["front, later", "front, later"]);
  const stepped = frame(4);
  fake.receive({ _about: { frame_id: "stepped" }, _frame: stepped });
  fake.set("_frozen_frame", stepped);
  for (const i of [5, 6]) fake.receive({ _about: { frame_id: "rear" }, _frame: frame(i) });
  assert.equal(stream.about.frame_id, "stepped");
  // The player shows the same sample again, with a new number.
  stepped.setFloat64(0, 7, true);
  fake.receive({ _about: { frame_id: "again" }, _frame: stepped });
  assert.equal(stream.about.frame_id, "stepped");
  stream.toggle();
  assert.deepEqual(said(), ["again", "again"]);
  end();
});

/** A frame that arrived at a second of Python's clock. */
function arrived(seconds: number): DataView {
  const bytes = frame(seconds * 10);
  bytes.setFloat64(24, seconds, true);
  return bytes;
}

test("widgets of a group freeze and step to the same moment, and are released together", () => {
  const group = { history: 30, _together: "robot" };
  const [laser, speed, alone] = [open(group), open(group), open({ history: 30, _together: "" })];
  for (const second of [1, 2, 3]) laser.fake.receive({ _frame: arrived(second) });
  for (const second of [0.9, 1.8, 2.2, 2.9, 3.1]) speed.fake.receive({ _frame: arrived(second) });
  alone.fake.receive({ _frame: arrived(1) });
  const shown = () => [laser.stream.shown?.arrived, speed.stream.shown?.arrived];
  laser.stream.toggle();
  assert.deepEqual([speed.stream.paused, alone.stream.paused, shown()], [true, false, [3, 3.1]]);
  laser.fake.receive({ _frame: arrived(4) });
  speed.fake.receive({ _frame: arrived(4) });
  assert.deepEqual(shown(), [3, 3.1]);
  for (const expected of [
    [2, 1.8],
    [1, 0.9],
    [1, 0.9],
  ]) {
    laser.stream.step(-1);
    assert.deepEqual(shown(), expected);
  }
  speed.stream.seek(2);
  assert.deepEqual(shown(), [2, 2.2], "any of them steps all");
  speed.stream.toggle();
  assert.deepEqual([laser.stream.paused, shown()], [false, [4, 4]]);
  for (const { end } of [laser, speed, alone]) end();
});

test("a group steps back within the samples that all of it remember, and one whose view ended is no longer in it", () => {
  const [laser, speed] = [open({ history: 30, _together: "a" }), open({ history: 0.1, _together: "a" })];
  for (const second of [1, 2, 3]) laser.fake.receive({ _frame: arrived(second) });
  for (const second of [1.1, 1.9, 2.5]) speed.fake.receive({ _frame: arrived(second) });
  laser.stream.toggle();
  laser.stream.seek(0);
  assert.deepEqual([laser.stream.shown?.arrived, speed.stream.shown?.arrived], [2, 1.9]);
  speed.end();
  laser.stream.seek(0);
  assert.equal(laser.stream.shown?.arrived, 1);
  laser.stream.toggle();
  assert.equal(speed.stream.paused, true);
  const forgetful = open({ history: 0, _together: "a" });
  for (const second of [1, 2, 3]) forgetful.fake.receive({ _frame: arrived(second) });
  laser.stream.toggle();
  laser.stream.seek(0);
  assert.deepEqual(
    [laser.stream.shown?.arrived, forgetful.stream.shown?.arrived],
    [1, 3],
    "one without a history stays",
  );
  forgetful.end();
  laser.end();
});

test("a moment is frozen only if its first sample since then is kept", () => {
  const { fake, stream, end } = open({ history: 30 });
  for (const second of [1, 2, 3]) fake.receive({ _frame: arrived(second) });
  assert.equal(stream.freezeAt(1.5), true);
  assert.deepEqual([stream.paused, stream.shown?.arrived], [true, 2]);
  assert.equal(stream.freezeAt(3.5), false, "nothing came since");
  assert.equal(stream.shown?.arrived, 2);
  end();

  const full = open({ history: 0.1 });
  full.fake.receive({ _frame: arrived(1) });
  full.stream.toggle();
  for (const second of [2, 3, 4, 5]) full.fake.receive({ _frame: arrived(second) });
  assert.equal(full.stream.freezeAt(3.5), false, "frozen for long, it keeps the newest without what came before it");
  assert.deepEqual([full.stream.freezeAt(1.5), full.stream.shown?.arrived], [true, 2]);
  full.end();

  const forgetful = open({ history: 0 });
  for (const second of [1, 2, 3]) forgetful.fake.receive({ _frame: arrived(second) });
  assert.deepEqual([forgetful.stream.freezeAt(2.5), forgetful.stream.paused], [false, false]);
  forgetful.end();

  const reloaded = open({ history: 30, _frame: arrived(3) });
  assert.deepEqual([reloaded.stream.freezeAt(1.5), reloaded.stream.paused], [false, false]);
  for (const second of [4, 5]) reloaded.fake.receive({ _frame: arrived(second) });
  assert.equal(reloaded.stream.freezeAt(1.5), false);
  assert.deepEqual([reloaded.stream.freezeAt(4.5), reloaded.stream.shown?.arrived], [true, 5]);
  reloaded.end();

  const frozen = open({ history: 30, paused: true, _frozen_frame: arrived(1), _frame: arrived(3) });
  assert.deepEqual([frozen.stream.freezeAt(2), frozen.stream.shown?.arrived], [false, 1]);
  frozen.end();
});
