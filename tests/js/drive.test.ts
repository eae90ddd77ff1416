import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { CENTER, isDriving, ofKeys, toKnob, toPlace } from "../../robowidgets/js/drive/knob.ts";
import { type PadMessage, PressLease, type State } from "../../robowidgets/js/drive/press.ts";
import { toText } from "../../robowidgets/js/drive/text.ts";
import { situation } from "./stop.ts";

test("up is forward and left turns to the left, up to the limits and never past them", () => {
  assert.deepEqual(toKnob(0, -100, 100), { forward: 1, turn: 0 });
  assert.deepEqual(toKnob(-100, 0, 100), { forward: 0, turn: 1 });
  assert.deepEqual(toKnob(900, 900, 100), { forward: -1, turn: -1 });
  const { forward, turn } = toKnob(-30, -60, 100);
  assert.ok(forward > 0.5 && forward < 0.6 && turn > 0.2 && turn < 0.3);
});

test("near the middle of an axis the robot drives straight, and beyond that the speed grows without a step", () => {
  assert.deepEqual(toKnob(5, -100, 100), { forward: 1, turn: 0 });
  assert.ok(Math.abs(toKnob(6.1, 0, 100).turn) < 0.01);
});

test("the knob is drawn under the pointer", () => {
  for (const [right, below] of [
    [0, 0],
    [50, -70],
    [-100, 100],
    [-20, 8],
  ] as const) {
    const place = toPlace({ ...CENTER, ...toKnob(right, below, 100) });
    assert.ok(Math.abs(place.right - right / 100) < 1e-9 && Math.abs(place.below - below / 100) < 1e-9);
  }
});

test("keys add up and opposite ones cancel", () => {
  assert.deepEqual(ofKeys([]), CENTER);
  assert.deepEqual(ofKeys(["ArrowUp", "KeyA"]), { forward: 1, turn: 1, lateral: 0 });
  assert.deepEqual(ofKeys(["ArrowUp", "KeyW", "ArrowRight"]), { forward: 1, turn: -1, lateral: 0 });
  assert.deepEqual(ofKeys(["KeyQ", "KeyS"]), { forward: -1, turn: 0, lateral: 1 });
  assert.deepEqual(ofKeys(["KeyQ", "KeyE"]), CENTER);
  assert.deepEqual(ofKeys(["KeyW", "KeyS", "ArrowLeft", "KeyD"]), CENTER);
  assert.ok(isDriving("KeyS", false) && !isDriving("KeyX", true));
  assert.ok(isDriving("KeyQ", true) && !isDriving("KeyQ", false), "only where the robot moves sideways");
});

const FULL = { ...CENTER, forward: 1 };

function open(send: (message: PadMessage) => void = () => {}) {
  mock.timers.reset();
  mock.timers.enable({ apis: ["setInterval"] });
  let now = 1000;
  const clock = mock.method(performance, "now", () => now);
  const sent: PadMessage[] = [];
  const states: State[] = [];
  const lease: PressLease = new PressLease(
    "pad",
    (message) => {
      sent.push(message);
      send(message);
    },
    () => states.push(lease.state),
  );
  const pass = (ms: number) => {
    for (let i = 0; i < ms; i += 10) {
      now += 10;
      mock.timers.tick(10);
    }
  };
  const close = () => {
    lease.release();
    clock.mock.restore();
    mock.timers.reset();
  };
  return { lease, sent, states, pass, close };
}

test("no speed is sent before the kernel has answered, then ten a second with the newest token", () => {
  const { lease, sent, pass, close } = open();
  lease.hold(FULL);
  pass(300);
  assert.deepEqual(sent, [{ act: "press", press: "pad-1" }]);
  lease.onAnswer({ press: "pad-1", token: 7 });
  assert.deepEqual(sent[1], { act: "hold", press: "pad-1", token: 7, ...FULL });
  for (let i = 0; i < 10; i++) {
    lease.onAnswer({ press: "pad-1", token: 8 + i });
    pass(100);
  }
  assert.deepEqual(
    sent.slice(2).map(({ token }) => token),
    [8, 9, 10, 11, 12, 13, 14, 15, 16, 17],
  );
  lease.release();
  assert.deepEqual(sent.at(-1), { act: "release", press: "pad-1" });
  pass(1000);
  assert.equal(sent.length, 13);
  close();
});

test("a moving knob is sent soon, but not at every step of the pointer", () => {
  const { lease, sent, pass, close } = open();
  lease.hold(CENTER);
  lease.onAnswer({ press: "pad-1", token: 1 });
  for (let i = 0; i < 8; i++) {
    pass(10);
    lease.hold({ ...CENTER, forward: i / 10 });
  }
  assert.deepEqual(
    sent.slice(2).map(({ forward }) => forward),
    [0.3, 0.7],
  );
  close();
});

test("half a second of silence ends a press, and only a new one drives", () => {
  const { lease, sent, states, pass, close } = open();
  lease.hold(FULL);
  lease.onAnswer({ press: "pad-1", token: 1 });
  pass(700);
  assert.deepEqual(states, ["asking", "driving", "silent"]);
  assert.deepEqual(sent.at(-1), { act: "release", press: "pad-1" });
  const count = sent.length;
  lease.onAnswer({ press: "pad-1", token: 2 });
  lease.onAnswer({ press: "pad-1", over: "released" });
  lease.hold({ ...CENTER, forward: 0.5 });
  pass(1000);
  assert.equal(lease.state, "late");
  assert.equal(sent.length, count);
  lease.release();
  lease.hold(FULL);
  lease.onAnswer({ press: "pad-1", token: 3 });
  assert.equal(lease.state, "asking");
  lease.onAnswer({ press: "pad-2", token: 4 });
  assert.equal(lease.state, "driving");
  close();
});

test("a pad that is released in silence shows it until the kernel answers", () => {
  const { lease, pass, close } = open();
  lease.hold(FULL);
  pass(700);
  lease.release();
  assert.equal(lease.state, "silent");
  lease.onAnswer({ press: "pad-1", over: "released" });
  assert.equal(lease.state, "free");
  close();
});

test("a press that Python ends stays over while it is held", () => {
  const { lease, sent, pass, close } = open();
  lease.hold(FULL);
  lease.onAnswer({ press: "pad-1", over: "taken" });
  const count = sent.length;
  lease.onAnswer({ press: "pad-1", token: 5 });
  pass(2000);
  assert.equal(lease.state, "taken");
  assert.equal(sent.length, count);
  close();
});

test("a kernel that has ended is silent", () => {
  const { lease, close } = open(() => {
    throw new Error("the comm is closed");
  });
  lease.hold(FULL);
  assert.equal(lease.state, "silent");
  close();
});

const say = (state: State, told: object = {}, more: object = {}, enabled = true) =>
  toText({ ...situation(told), ...more }, { state, press: "pad-1" }, enabled);

test("texts show the state and the next action", () => {
  assert.deepEqual(say("free"), { text: "stopped", hint: "drag, or arrow keys", kind: "rest" });
  assert.equal(say("driving", { driver: "pad-1" }).text, "driving");
  assert.equal(say("free", { ready: false }).text, "no feed");
  assert.equal(say("nothing", { ready: false }).text, "no feed");
  assert.equal(say("free", {}, {}, false).text, "switched off");
  assert.equal(say("free", { speed: [0.1, 0, 0] }).text, "stopping");
  for (const state of ["free", "nothing"] as const) {
    assert.deepEqual(say(state, { ready: false, cause: "the feed is closed" }), {
      text: "the feed is closed",
      hint: "open it and connect again",
      kind: "rest",
    });
  }
  assert.deepEqual(say("failed", { cause: "no route to the robot" }), {
    text: "no route to the robot",
    hint: "let go and press again",
    kind: "warn",
  });
  assert.equal(say("late").hint, "let go and press again");
});

test("another driver is named", () => {
  assert.deepEqual(say("free", { driver: "program" }), {
    text: "a program drives",
    hint: "press to take over",
    kind: "rest",
  });
  assert.deepEqual(say("free", { driver: "assistant" }), {
    text: "an assistant drives",
    hint: "press to take over",
    kind: "rest",
  });
  assert.equal(say("free", { driver: "other-1" }).text, "driven from another pad");
  assert.equal(say("free", { driver: "pad-1" }).text, "stopped");
  assert.equal(say("taken", { driver: "other-1" }).text, "driven from another pad");
});

test("while the kernel does not answer, the text does not claim that a program was stopped", () => {
  assert.deepEqual(say("silent"), { text: "kernel busy: stopped", hint: "it does not answer", kind: "warn" });
  assert.equal(say("silent", { driver: "program", speed: [0.2, 0, 0] }).text, "kernel busy; a program drives");
  assert.equal(say("silent", { driver: "pad-1", speed: [0.2, 0, 0] }).text, "kernel busy: stopping");
  assert.equal(say("late", { driver: "program", speed: [0.2, 0, 0] }).text, "no answer in time; a program drives");
  assert.equal(say("free", {}, { hears: false }).hint, "the kernel is busy");
  assert.equal(say("silent", { driver: "program" }, { silence: "no word" }).text, "no word");
});

test("a latched stop comes before the text of the press", () => {
  assert.equal(say("driving", { stopped: true }).text, "nobody may drive");
  assert.deepEqual(say("stopped"), { text: "stopped", hint: "let go and press again", kind: "rest" });
});
