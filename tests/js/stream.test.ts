import assert from "node:assert/strict";
import { test } from "node:test";
import { Reader } from "../../robowidgets/js/shared/bytes.ts";
import { type Frame, readHead, Stream } from "../../robowidgets/js/shared/stream.ts";
import { FakeModel } from "./models.ts";

const OFFSET = 5;

/** A frame with nothing but a head, amid the bytes of a larger message. */
function frame(sequence: number, rate = 40): DataView {
  const bytes = new DataView(new ArrayBuffer(OFFSET + 24 + 3), OFFSET, 24);
  bytes.setFloat64(0, sequence, true);
  bytes.setFloat64(8, rate, true);
  return bytes;
}

function open(values: Record<string, unknown> = {}) {
  const fake = new FakeModel({ paused: false, _held: new DataView(new ArrayBuffer(0)), ...values });
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

test("a new view shows what its model holds", () => {
  const { stream, end } = open({ _frame: frame(7) });
  assert.deepEqual(stream.shown, { sequence: 7, rate: 40 });
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

test("a person's freeze holds the picture here and tells Python, with exactly the frame's bytes", () => {
  const { fake, stream, end } = open({ _frame: frame(3) });
  stream.toggle();
  fake.receive({ _frame: frame(10) });
  assert.equal(stream.paused, true);
  assert.equal(stream.shown?.sequence, 3);
  assert.equal(stream.since, 7);
  const [message] = fake.saved;
  assert.deepEqual(Object.keys(message ?? {}).sort(), ["_held", "paused"]);
  const held = message?._held as DataView;
  // Hosts send the whole buffer under a view, so there must be nothing else in it.
  assert.equal(held.buffer.byteLength, 24);
  assert.equal(held.getFloat64(0, true), 3);
  end();
});

test("released, the newest shows at once, and nothing is held", () => {
  const { fake, stream, end } = open({ _frame: frame(3) });
  stream.toggle();
  fake.receive({ _frame: frame(10) });
  stream.toggle();
  assert.equal(stream.paused, false);
  assert.equal(stream.shown?.sequence, 10);
  assert.equal(stream.since, 0);
  assert.equal((fake.saved[1] as { _held: DataView })._held.byteLength, 0);
  assert.equal(fake.saved[1]?.paused, false);
  end();
});

test("Python's freeze holds what is here until Python says what it holds", () => {
  const { fake, stream, end } = open({ _frame: frame(3) });
  fake.receive({ paused: true });
  fake.receive({ _frame: frame(4) });
  assert.equal(stream.shown?.sequence, 3);
  fake.receive({ _held: frame(4) });
  fake.receive({ _frame: frame(9) });
  assert.equal(stream.shown?.sequence, 4);
  assert.equal(stream.since, 5);
  fake.receive({ paused: false });
  assert.equal(stream.shown?.sequence, 9);
  fake.receive({ _held: new DataView(new ArrayBuffer(0)) });
  fake.receive({ paused: true });
  assert.equal(stream.shown?.sequence, 9);
  end();
});

test("a reload while frozen finds the frozen picture and the count", () => {
  const { stream, end } = open({ paused: true, _held: frame(3), _frame: frame(8) });
  assert.equal(stream.shown?.sequence, 3);
  assert.equal(stream.since, 5);
  end();
});

test("frozen before the first frame, nothing shows and all that came is counted", () => {
  const { fake, stream, end } = open();
  stream.toggle();
  fake.receive({ _frame: frame(4) });
  assert.equal(stream.shown?.sequence, undefined);
  stream.toggle();
  assert.equal(stream.shown?.sequence, 4);
  end();
});

test("a kernel that counts anew makes no negative count", () => {
  const { fake, stream, end } = open({ paused: true, _held: frame(100), _frame: frame(100) });
  fake.receive({ _frame: frame(2) });
  assert.equal(stream.since, 0);
  end();
});

test("it is live for two seconds after a frame, and says when that ends", (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  const { fake, stream, end, signal } = open();
  let told = 0;
  stream.listen(() => told++, signal);
  fake.receive({ _frame: frame(1) });
  assert.equal(stream.live, true);
  t.mock.timers.tick(1999);
  fake.receive({ _frame: frame(2) });
  t.mock.timers.tick(1999);
  assert.equal(stream.live, true);
  assert.equal(told, 2);
  t.mock.timers.tick(1);
  assert.equal(stream.live, false);
  assert.equal(told, 3);
  end();
});

test("views hear of every change until their signal ends, and the model is left alone at the end", () => {
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
  fake.receive({ _held: frame(1) });
  assert.deepEqual(heard, { first: 2, second: 4 });
  end();
  assert.equal(fake.listening, 0);
  fake.receive({ _frame: frame(2) });
  assert.deepEqual(heard, { first: 2, second: 4 });
});
