import assert from "node:assert/strict";
import { test } from "node:test";
import { walk, watchGestures } from "../../robowidgets/js/laser/gestures.ts";
import type { Drag, Layer } from "../../robowidgets/js/laser/layer.ts";

/** An element with a place in the page, and simulated events of the user. */
class Element extends EventTarget {
  closest = () => null;
  parentElement = new EventTarget();
  getBoundingClientRect = () => ({ left: 100, top: 50 });
  setPointerCapture = () => {};
  contains = () => true;
}
const pointer = (type: string, x: number, y: number, more = {}) =>
  Object.assign(new Event(type, { cancelable: true }), {
    clientX: x,
    clientY: y,
    button: 0,
    isPrimary: true,
    pointerId: 1,
    pointerType: "mouse",
    ...more,
  });
const key = (name: string) => Object.assign(new Event("keydown", { cancelable: true }), { key: name });

/** A picture with layers, of which the last one is on top, and their calls. */
function picture(...layers: Partial<Layer>[]) {
  Object.assign(globalThis, { window: new EventTarget(), HTMLInputElement: class {}, Element });
  const element = new Element();
  const zoomed: number[] = [];
  const zoom = { onZoom: (direction: number) => void zoomed.push(direction), canZoom: () => true };
  const signal = new AbortController().signal;
  watchGestures(element as unknown as HTMLElement, layers as Layer[], zoom, signal);
  const press = (name: string) => {
    const event = key(name);
    element.parentElement.dispatchEvent(event);
    return event.defaultPrevented;
  };
  return {
    element,
    zoomed,
    press,
    send: (...given: Parameters<typeof pointer>) => element.dispatchEvent(pointer(...given)),
  };
}

test("the picture has the tooltip of the drawing under the pointer, also below a layer that takes the pointer", () => {
  const below: Partial<Layer> = { tip: ({ x }) => (x < 10 ? "an index" : "") };
  const { element, send } = picture(below, { onHover: () => true });
  const tips = [105, 120].map((x) => {
    send("pointermove", x, 60);
    return (element as unknown as HTMLElement).title;
  });
  assert.deepEqual(tips, ["an index", ""]);
});

test("the layer on top takes its events, and the one below gets the rest", () => {
  const told: string[] = [];
  const below: Partial<Layer> = {
    onHover: (point) => Boolean(told.push(`below hover ${point?.x}`)),
    onClick: (point) => Boolean(told.push(`below click ${point.x},${point.y}`)),
    onKey: ({ key }) => Boolean(told.push(`below ${key}`)),
  };
  const above: Partial<Layer> = {
    onHover: (point) => (point?.x ?? 0) > 10,
    onClick: (point) => point.x > 10,
    onKey: ({ key }) => key === "c",
  };
  const { send, press, zoomed } = picture(below, above);
  send("pointermove", 105, 60);
  send("pointermove", 120, 60);
  send("click", 105, 60);
  send("click", 120, 60);
  assert.ok(press("c") && press("x"));
  assert.deepEqual(told, ["below hover 5", "below hover undefined", "below click 5,10", "below x"]);
  assert.deepEqual(zoomed, []);
});

test("a key that the layers do not take zooms, or is left to the page", () => {
  const { press, zoomed } = picture({ onKey: () => false });
  assert.ok(press("+"));
  assert.ok(!press("q"));
  assert.deepEqual(zoomed, [-1]);
});

test("a drag begins when the pointer has moved, and does not end in a click", () => {
  const told: string[] = [];
  const drag: Drag = {
    move: ({ x }) => told.push(`move ${x}`),
    end: () => told.push("end"),
    cancel: () => told.push("cancel"),
  };
  const { send, press } = picture({
    onPress: ({ x }) => (x < 50 ? drag : null),
    onHover: (point) => Boolean(told.push(point ? "hover" : "leave")),
    onClick: () => Boolean(told.push("click")),
  });
  for (const [type, x] of [
    ["pointerdown", 110],
    ["pointermove", 112],
    ["pointerup", 112],
    ["click", 112],
  ] as const) {
    send(type, x, 60);
  }
  assert.deepEqual(told.splice(0), ["hover", "cancel", "click"], "a press that does not move is a click");
  for (const [type, x] of [
    ["pointerdown", 110],
    ["pointermove", 130],
    ["pointerup", 130],
    ["click", 130],
  ] as const) {
    send(type, x, 60);
  }
  assert.deepEqual(told.splice(0), ["leave", "move 30", "end"]);
  send("pointerdown", 110, 60);
  send("pointermove", 130, 60);
  assert.ok(press("Escape"), "Escape puts back what was");
  send("pointerup", 130, 60);
  send("click", 130, 60);
  assert.deepEqual(told.splice(0), ["leave", "move 30", "cancel"]);
  send("pointerdown", 190, 60);
  send("pointermove", 130, 60);
  send("click", 130, 60);
  assert.deepEqual(told, ["hover", "click"], "a press that no layer takes is none");
});

test("a finger that a layer takes does not scroll the page; without moving it is a click", () => {
  const told: string[] = [];
  const drag: Drag = { move: () => told.push("move"), end: () => told.push("end"), cancel: () => told.push("cancel") };
  const { element, send } = picture({
    onPress: (_, isTouch) => (isTouch ? drag : null),
    onClick: () => Boolean(told.push("click")),
  });
  const touch = { pointerType: "touch" };
  const start = () => {
    const event = new Event("touchstart", { cancelable: true });
    element.dispatchEvent(event);
    return event.defaultPrevented;
  };
  assert.ok(!start());
  send("pointerdown", 110, 60, touch);
  assert.ok(start());
  send("pointerup", 110, 60, touch);
  assert.deepEqual(told, ["cancel", "click"]);
});

test("Tab picks the stops of all layers from the top one down, Shift and Tab go back, and beyond the last it leads out", () => {
  const layerOf = (...names: string[]) => {
    const stops = {
      names,
      picked: "",
      pick(name: string) {
        this.picked = name;
      },
    };
    return { stops };
  };
  const [sectors, none, pins] = [layerOf("front", "left"), {}, layerOf("door")];
  const picked = (isBack: boolean) => {
    const goesOn = walk([sectors, none, pins], isBack);
    return [goesOn, sectors.stops.picked, pins.stops.picked];
  };
  assert.deepEqual(picked(false), [true, "front", ""]);
  assert.deepEqual(picked(false), [true, "left", ""]);
  assert.deepEqual(picked(false), [true, "", "door"]);
  assert.deepEqual(picked(true), [true, "left", ""]);
  assert.deepEqual(picked(false), [true, "", "door"]);
  assert.deepEqual(picked(false), [false, "", ""]);
  assert.deepEqual(picked(true), [true, "", "door"]);
  assert.equal(walk([{}], false), false);
});
