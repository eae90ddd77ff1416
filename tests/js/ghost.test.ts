import assert from "node:assert/strict";
import { test } from "node:test";
import { Ghost } from "../../robowidgets/js/laser/ghost.ts";
import { decodeScan } from "../../robowidgets/js/shared/frames/scan.ts";
import { Stream } from "../../robowidgets/js/shared/stream.ts";
import { FakeModel } from "./models.ts";
import { frameOf } from "./vectors.ts";

function frame(sequence: number, arrived: number): DataView {
  const bytes = frameOf("laser");
  bytes.setFloat64(0, sequence, true);
  bytes.setFloat64(24, arrived, true);
  return bytes;
}

test("the age of a ghost is the time between arrivals, and is hidden in a player", () => {
  const fake = new FakeModel({
    paused: false,
    history: 30,
    _about: {},
    _source: {},
    _ghost: frame(3, 7),
    _ghost_of: "",
  });
  const controller = new AbortController();
  const stream = new Stream(fake.model, decodeScan, controller.signal);
  const ghost = new Ghost(fake.model, stream, () => {}, controller.signal);
  fake.receive({ _frame: frame(5, 9.5) });
  assert.equal(ghost.words, "2.5 s ago");
  fake.receive({ history: 0 });
  assert.equal(ghost.words, "pinned");
  fake.receive({ history: 30, _ghost: frame(0, 7) });
  assert.equal(ghost.words, "pinned");
  controller.abort();
});
