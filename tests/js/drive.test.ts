import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { Grip, type Message, type State } from "../../robowidgets/js/drive/grip.ts";
import { CENTER, isDriving, ofKeys, toKnob, toPlace } from "../../robowidgets/js/drive/knob.ts";
import { toWords } from "../../robowidgets/js/drive/words.ts";

test("up is forward and left turns to the left, up to the limits and never past them", () => {
  assert.deepEqual(toKnob(0, -100, 100), { forward: 1, turn: 0 });
  assert.deepEqual(toKnob(-100, 0, 100), { forward: 0, turn: 1 });
  assert.deepEqual(toKnob(900, 900, 100), { forward: -1, turn: -1 });
  const { forward, turn } = toKnob(-30, -60, 100);
  assert.ok(forward > 0.5 && forward < 0.6 && turn > 0.2 && turn < 0.3);
});

test("near the middle of an axis it is driven straight, and from there on without a step", () => {
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
    const place = toPlace(toKnob(right, below, 100));
    assert.ok(Math.abs(place.right - right / 100) < 1e-9 && Math.abs(place.below - below / 100) < 1e-9);
  }
});

test("keys add up and opposite ones cancel", () => {
  assert.deepEqual(ofKeys([]), CENTER);
  assert.deepEqual(ofKeys(["ArrowUp", "KeyA"]), { forward: 1, turn: 1 });
  assert.deepEqual(ofKeys(["ArrowUp", "KeyW", "ArrowRight"]), { forward: 1, turn: -1 });
  assert.deepEqual(ofKeys(["KeyW", "KeyS", "ArrowLeft", "KeyD"]), CENTER);
  assert.ok(isDriving("KeyS") && !isDriving("KeyX"));
});

const FULL = { forward: 1, turn: 0 };

function open(send: (message: Message) => void = () => {}) {
  mock.timers.reset();
  mock.timers.enable({ apis: ["setInterval"] });
  let now = 1000;
  const clock = mock.method(performance, "now", () => now);
  const sent: Message[] = [];
  const states: State[] = [];
  const grip: Grip = new Grip(
    "pad",
    (message) => {
      sent.push(message);
      send(message);
    },
    () => states.push(grip.state),
  );
  const pass = (ms: number) => {
    for (let i = 0; i < ms; i += 10) {
      now += 10;
      mock.timers.tick(10);
    }
  };
  const close = () => {
    grip.release();
    clock.mock.restore();
    mock.timers.reset();
  };
  return { grip, sent, states, pass, close };
}

test("no speed is sent before the kernel has answered, then ten a second with the newest token", () => {
  const { grip, sent, pass, close } = open();
  grip.hold(FULL);
  pass(300);
  assert.deepEqual(sent, [{ act: "press", press: "pad-1" }]);
  grip.onAnswer({ press: "pad-1", token: 7 });
  assert.deepEqual(sent[1], { act: "hold", press: "pad-1", token: 7, ...FULL });
  for (let i = 0; i < 10; i++) {
    grip.onAnswer({ press: "pad-1", token: 8 + i });
    pass(100);
  }
  assert.deepEqual(
    sent.slice(2).map(({ token }) => token),
    [8, 9, 10, 11, 12, 13, 14, 15, 16, 17],
  );
  grip.release();
  assert.deepEqual(sent.at(-1), { act: "release", press: "pad-1" });
  pass(1000);
  assert.equal(sent.length, 13);
  close();
});

test("a knob that moves is told soon, but not at every step of the pointer", () => {
  const { grip, sent, pass, close } = open();
  grip.hold(CENTER);
  grip.onAnswer({ press: "pad-1", token: 1 });
  for (let i = 0; i < 8; i++) {
    pass(10);
    grip.hold({ forward: i / 10, turn: 0 });
  }
  assert.deepEqual(
    sent.slice(2).map(({ forward }) => forward),
    [0.3, 0.7],
  );
  close();
});

test("half a second of silence ends a press, and only a new one drives", () => {
  const { grip, sent, states, pass, close } = open();
  grip.hold(FULL);
  grip.onAnswer({ press: "pad-1", token: 1 });
  pass(700);
  assert.deepEqual(states, ["asking", "driving", "silent"]);
  assert.deepEqual(sent.at(-1), { act: "release", press: "pad-1" });
  const count = sent.length;
  grip.onAnswer({ press: "pad-1", token: 2 });
  grip.onAnswer({ press: "pad-1", over: "released" });
  grip.hold({ forward: 0.5, turn: 0 });
  pass(1000);
  assert.equal(grip.state, "late");
  assert.equal(sent.length, count);
  grip.release();
  grip.hold(FULL);
  grip.onAnswer({ press: "pad-1", token: 3 });
  assert.equal(grip.state, "asking");
  grip.onAnswer({ press: "pad-2", token: 4 });
  assert.equal(grip.state, "driving");
  close();
});

test("let go in silence, it says so until the kernel answers", () => {
  const { grip, pass, close } = open();
  grip.hold(FULL);
  pass(700);
  grip.release();
  assert.equal(grip.state, "silent");
  grip.onAnswer({ press: "pad-1", over: "released" });
  assert.equal(grip.state, "free");
  close();
});

test("a press that Python ends stays over while it is held", () => {
  const { grip, sent, pass, close } = open();
  grip.hold(FULL);
  grip.onAnswer({ press: "pad-1", over: "taken" });
  const count = sent.length;
  grip.onAnswer({ press: "pad-1", token: 5 });
  pass(2000);
  assert.equal(grip.state, "taken");
  assert.equal(sent.length, count);
  close();
});

test("a kernel that is gone is silence", () => {
  const { grip, close } = open(() => {
    throw new Error("the comm is closed");
  });
  grip.hold(FULL);
  assert.equal(grip.state, "silent");
  close();
});

test("words say what is going on and what to do", () => {
  const usual = { state: "free" as State, ready: true, enabled: true, elsewhere: false, cause: "" };
  const say = (more: object) => toWords({ ...usual, ...more });
  assert.equal(say({}).text, "stopped");
  assert.equal(say({ state: "driving" }).text, "driving");
  assert.equal(say({ ready: false }).text, "no feed");
  assert.equal(say({ ready: false, state: "nothing" }).text, "no feed");
  assert.equal(say({ enabled: false }).text, "switched off");
  assert.equal(say({ elsewhere: true }).text, "driven from another pad");
  assert.deepEqual(say({ state: "silent" }), {
    text: "kernel busy: stopped",
    hint: "it does not answer",
    kind: "warn",
  });
  for (const state of ["free", "nothing"]) {
    assert.deepEqual(say({ state, ready: false, cause: "the feed is closed" }), {
      text: "the feed is closed",
      hint: "open it and connect again",
      kind: "rest",
    });
  }
  assert.deepEqual(say({ state: "failed", cause: "no route to the robot" }), {
    text: "no route to the robot",
    hint: "let go and press again",
    kind: "warn",
  });
  assert.deepEqual(say({ state: "late" }).hint, "let go and press again");
});
