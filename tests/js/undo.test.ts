import assert from "node:assert/strict";
import { test } from "node:test";
import { SectorStore } from "../../robowidgets/js/laser/sector_store.ts";
import { Changes, keepChange, watchUndo } from "../../robowidgets/js/shared/undo.ts";
import { document } from "./looks/page.ts";
import { FakeModel } from "./models.ts";

const FRONT = { start: -0.5, end: 0.5 };
const LEFT = { start: 1, end: 2 };

function press(at: Element, more: KeyboardEventInit = {}) {
  const event = new KeyboardEvent("keydown", { key: "z", ctrlKey: true, bubbles: true, cancelable: true, ...more });
  at.dispatchEvent(event);
  return event;
}

/** A card with a picture and a field in it, within a page. */
function makeCard() {
  const card = document.createElement("div");
  const [picture, field] = [document.createElement("div"), document.createElement("input")];
  card.append(picture, field);
  document.body.append(card);
  return { card, picture, field };
}

test("Ctrl+Z undoes the changes in a card, the last one first, but not in a field of text", () => {
  const { card, picture, field } = makeCard();
  const said: string[] = [];
  const undone: string[] = [];
  watchUndo(card, (words) => said.push(words), new AbortController().signal);
  for (const words of ["one", "two"]) keepChange(picture, { words, undo: () => undone.push(words) });
  assert.equal(press(field).defaultPrevented, false);
  assert.equal(press(picture, { shiftKey: true }).defaultPrevented, false);
  assert.deepEqual(undone, []);
  assert.equal(press(picture).defaultPrevented, true);
  press(picture);
  assert.equal(press(picture).defaultPrevented, false);
  assert.deepEqual(undone, ["two", "one"]);
  assert.deepEqual(said, ["back: two", "back: one"]);
});

test("a change that was refused is left out", () => {
  const { card, picture } = makeCard();
  const changes = new Changes(card, new AbortController().signal);
  for (const words of ["one", "two"]) {
    keepChange(picture, { words, undo: () => {}, isRefused: () => words === "two" });
  }
  assert.deepEqual([changes.undo(), changes.undo()], ["back: one", ""]);
});

test("the changes in all cards of a screen are undone in their order, in whatever card the key is pressed", () => {
  const screen = document.createElement("div");
  const [one, other] = [makeCard(), makeCard()];
  screen.append(one.card, other.card);
  const { signal } = new AbortController();
  const changes = new Changes(screen, signal);
  const said: string[] = [];
  for (const { card } of [one, other]) watchUndo(card, (words) => said.push(words), signal);
  keepChange(one.picture, { words: "one", undo: () => {} });
  keepChange(other.picture, { words: "other", undo: () => {} });
  press(one.picture);
  assert.deepEqual(said, []);
  assert.deepEqual([changes.undo(), changes.undo(), changes.undo()], ["back: other", "back: one", ""]);
});

test("a sector that was changed, renamed or removed comes back, and those that Python set since stay", () => {
  const { card, picture } = makeCard();
  const model = new FakeModel({ _sectors: { front: FRONT, left: LEFT }, _selection: { name: "front" } });
  const closing = new AbortController();
  const store = new SectorStore(model.model as never, picture, closing.signal);
  const said: string[] = [];
  watchUndo(card, (words) => said.push(words), closing.signal);
  const { now } = store;
  store.put({ name: "front", sector: { start: -0.2, end: 0.5 } });
  store.keepUndo(now);
  store.pick("left");
  store.keep("port");
  store.remove();
  assert.deepEqual(Object.keys(store.kept), ["front"]);
  model.receive({ _sectors: { ...store.kept, back: LEFT } });
  press(picture);
  press(picture);
  assert.deepEqual(store.kept, { front: { start: -0.2, end: 0.5 }, back: LEFT, left: LEFT });
  press(picture);
  assert.deepEqual(store.kept, { front: FRONT, back: LEFT, left: LEFT });
  assert.deepEqual(said, ["back: sector “port”", "back: sector “port”", "back: sector “front”"]);
  closing.abort();
});

test("a sector that Python has changed since, or has added, stays", () => {
  const { picture } = makeCard();
  const model = new FakeModel({ _sectors: { front: FRONT }, _selection: {} });
  const closing = new AbortController();
  const store = new SectorStore(model.model as never, picture, closing.signal);
  const changes = new Changes(picture, new AbortController().signal);
  const { now } = store;
  store.pick("front");
  model.receive({ _sectors: { ...store.kept, back: LEFT } });
  store.keepUndo(now);
  assert.equal(changes.undo(), "");
  assert.deepEqual(store.kept, { front: FRONT, back: LEFT });
  const { now: before } = store;
  store.put({ name: "front", sector: LEFT });
  store.keepUndo(before);
  model.receive({ _sectors: { ...store.kept, front: { start: 0, end: 1 } } });
  closing.abort();
  const { length } = model.saved;
  changes.undo();
  assert.deepEqual(store.kept, { front: { start: 0, end: 1 }, back: LEFT });
  assert.ok(model.saved.length > length, "the view that made the change has ended");
});

test("the choice of a kept sector is not a change", () => {
  const { card, picture } = makeCard();
  const model = new FakeModel({ _sectors: { front: FRONT }, _selection: {} });
  const { signal } = new AbortController();
  const store = new SectorStore(model.model as never, picture, signal);
  const changes = new Changes(card, signal);
  const { now } = store;
  store.pick("front");
  store.keepUndo(now);
  assert.equal(changes.undo(), "");
});
