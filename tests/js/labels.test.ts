import assert from "node:assert/strict";
import { test } from "node:test";
import { Labels } from "../../robowidgets/js/player/labels.ts";
import { Changes } from "../../robowidgets/js/shared/undo.ts";
import { document } from "./looks/page.ts";
import { FakeModel } from "./models.ts";

const DOOR = [3, 4, "door"];

/** A player with one label, whose removal the user asks for. */
function remove() {
  const { signal } = new AbortController();
  const model = new FakeModel({ labels: [DOOR], selection: null });
  const playback = { time: 0, shown: 0, seek: () => {} };
  const labels = new Labels(model.model, playback as never, () => {}, signal);
  const card = document.createElement("div");
  card.append(labels.lane);
  document.body.append(card);
  const changes = new Changes(card, signal);
  labels.update(0, 10);
  const label = labels.lane.querySelector("button") as HTMLElement;
  label.dispatchEvent(new KeyboardEvent("keydown", { key: "Delete", bubbles: true }));
  assert.deepEqual(model.sent, [{ label: [null, DOOR] }]);
  return { model, changes };
}

test("a removal is undone in its turn, once the kernel has answered", () => {
  const { model, changes } = remove();
  assert.equal(changes.undo(), "back: label “door”");
  assert.equal(model.sent.length, 1);
  model.tell({ labelled: [null, DOOR], stored: null, problem: "" });
  assert.deepEqual(model.sent.slice(1), [{ label: [DOOR, null] }]);
  assert.equal(changes.undo(), "");
});

test("a removal that the kernel refused is not undone", () => {
  const { model, changes } = remove();
  model.tell({ labelled: [null, DOOR], stored: null, problem: "the disk is full" });
  assert.equal(changes.undo(), "");
  assert.equal(model.sent.length, 1);
});
