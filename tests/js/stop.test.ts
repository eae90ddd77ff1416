import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { ANSWER_MS, END_MS, type Note, StopControl } from "../../robowidgets/js/shared/driving/control.ts";
import { type Situation, toBar, toDriverText } from "../../robowidgets/js/shared/driving/text.ts";
import type { Told } from "../../robowidgets/js/shared/driving/traits.ts";
import { BEAT_MS, KERNEL_BUSY_MS, KERNEL_SILENT_MS } from "../../robowidgets/js/shared/staleness.ts";
import { FakeModel } from "./models.ts";
import { situation, told } from "./stop.ts";

/** Runs everything that waits for promises. */
const settle = async () => {
  for (let i = 0; i < 10; i++) await Promise.resolve();
};

function open(interrupt?: () => Promise<void>, first: Partial<Told> = {}) {
  mock.timers.reset();
  mock.timers.enable({ apis: ["setInterval", "setTimeout"] });
  let now = 1000;
  const clock = mock.method(performance, "now", () => now);
  const sent: { act: string; press: string; token: number }[] = [];
  const fake = new FakeModel({ _state: told(first) });
  const model = Object.assign(fake, {
    send: (message: (typeof sent)[number]) => void sent.push(message),
    widget_manager: interrupt && { kernel: { interrupt } },
  }).model;
  const end = new AbortController();
  const control = new StopControl(model, "view", () => {}, end.signal);
  const pass = async (ms: number) => {
    for (let i = 0; i < ms; i += 10) {
      now += 10;
      mock.timers.tick(10);
      await settle();
    }
  };
  const close = () => {
    end.abort();
    assert.equal(fake.listening, 0);
    clock.mock.restore();
    mock.timers.reset();
  };
  const state = (more: Partial<Told>) => fake.receive({ _state: told(more) });
  const acts = () => sent.map(({ act }) => act).filter((act) => act !== "beat");
  const answer = (token: number) => fake.tell({ beat: "view", token });
  return { control, fake, sent, acts, state, answer, pass, close };
}

test("a stop that is answered in time does not interrupt the kernel", async () => {
  const interrupt = mock.fn(async () => {});
  const { control, acts, state, pass, close } = open(interrupt);
  control.stop();
  assert.deepEqual(acts(), ["stop"]);
  assert.equal(control.note, "asking");
  await pass(ANSWER_MS - 50);
  state({ stopped: true });
  assert.equal(control.note, "");
  await pass(5000);
  assert.equal(interrupt.mock.callCount(), 0);
  control.stop();
  assert.deepEqual(acts(), ["stop", "stop"]);
  await pass(5000);
  assert.equal(interrupt.mock.callCount(), 0, "it is latched already");
  close();
});

test("a kernel that does not answer is interrupted, once, and the text shows it until driving is allowed", async () => {
  const interrupt = mock.fn(async () => {});
  const { control, state, pass, close } = open(interrupt);
  control.stop();
  await pass(ANSWER_MS);
  assert.equal(interrupt.mock.callCount(), 1);
  assert.equal(control.note, "interrupted");
  state({ stopped: true });
  await pass(END_MS + 100);
  assert.equal(control.note, "interrupted");
  assert.equal(interrupt.mock.callCount(), 1);
  state({});
  assert.equal(control.note, "");
  close();
});

test("the text shows a cell that goes on after the interrupt, until it has ended", async () => {
  const { control, state, pass, close } = open(async () => {});
  control.stop();
  await pass(ANSWER_MS + END_MS);
  assert.equal(control.note, "ignored");
  state({ stopped: true });
  assert.equal(control.note, "interrupted");
  close();
});

for (const [where, interrupt] of [
  ["the host hides the kernel", undefined],
  ["the server refuses", () => Promise.reject(new Error("403"))],
] as const) {
  test(`without a way to a busy kernel the text shows it: ${where}`, async () => {
    const { control, state, pass, close } = open(interrupt);
    control.stop();
    await pass(ANSWER_MS);
    assert.equal(control.note, "unreachable");
    state({ stopped: true });
    assert.equal(control.note, "", "the message was handled after all");
    close();
  });
}

test("the text shows a server that does not answer the interrupt, until its answer arrives after all", async () => {
  let answer = () => {};
  const { control, state, pass, close } = open(() => new Promise((resolve) => (answer = resolve)), {
    driver: "program",
  });
  control.stop();
  await pass(ANSWER_MS + END_MS - 100);
  assert.equal(control.note, "asking");
  await pass(200);
  assert.equal(control.note, "unreachable");
  answer();
  await pass(100);
  assert.equal(control.note, "interrupted");
  state({ stopped: true });
  await pass(END_MS + 100);
  assert.equal(control.note, "interrupted");
  close();
});

test("allowing carries the newest token, and a refusal is for the view that asked", () => {
  const { control, fake, sent, answer, close } = open(undefined, { stopped: true });
  answer(7);
  control.allow();
  assert.deepEqual(sent.at(-1), { act: "allow", press: "view", token: 7 });
  fake.tell({ refused: "another" });
  assert.equal(control.note, "");
  fake.tell({ refused: "view" });
  assert.equal(control.note, "refused");
  close();
});

test("a busy kernel gets no long queue of beats, and counts as not answering", async () => {
  const { control, sent, answer, pass, close } = open();
  assert.deepEqual(
    sent.map(({ act }) => act),
    ["beat"],
  );
  for (let i = 0; i < 3; i++) {
    answer(i);
    await pass(BEAT_MS);
  }
  assert.equal(sent.length, 4);
  assert.ok(control.hears);
  await pass(KERNEL_BUSY_MS);
  assert.ok(!control.hears);
  await pass(60_000);
  assert.ok(sent.length < 12, `${sent.length} messages wait`);
  answer(9);
  assert.ok(control.hears);
  close();
});

test("messages make a page with slow timers beat", async () => {
  const { sent, state, answer, close } = open();
  answer(1);
  const clock = performance.now() + BEAT_MS;
  mock.method(performance, "now", () => clock);
  state({ driver: "program" });
  assert.equal(sent.length, 2);
  state({ driver: "program", speed: [1, 0, 0] });
  assert.equal(sent.length, 2);
  close();
});

test("the last state of a robot is current for a moment, and a missing robot stays so", async () => {
  const { control, state, pass, close } = open();
  state({ speed: [0.2, 0, 0] });
  await pass(KERNEL_SILENT_MS - 100);
  assert.equal(control.silence, "");
  await pass(200);
  assert.equal(control.silence, "no word from the kernel for 2.6 s");
  state({ ready: false });
  await pass(60_000);
  assert.equal(control.silence, "");
  close();
});

const SILENT = "no word from the kernel for 5.0 s";
const say = (more: Partial<Told>, other: Partial<Situation> = {}) => toDriverText({ ...situation(more), ...other });

test("the bar shows the driver and the speed", () => {
  assert.equal(say({}).text, "nobody drives");
  assert.equal(say({ idle: "the simulation wanders by itself" }).text, "the simulation wanders by itself");
  assert.equal(say({ speed: [0.1, 0, 0] }).text, "stopping");
  const speed = "0.20\u00A0m/s,\u00A0\u22120.50\u00A0rad/s";
  assert.equal(say({ driver: "program", speed: [0.2, -0.5, 0] }).text, `a program drives /cmd_vel: ${speed}`);
  assert.equal(say({ driver: "program", speed: [0.2, -0.5, 0], topic: "" }).text, `a program drives: ${speed}`);
  assert.equal(
    say({ driver: "assistant", left: 4, speed: [0.2, -0.5, 0] }).text,
    `an assistant drives /cmd_vel: ${speed}, 4\u00A0s left`,
  );
  assert.equal(say({ driver: "p", speed: [0.2, -0.5, 0] }).text, `a hand drives /cmd_vel from a pad: ${speed}`);
  const [left, right] = [0.07, -0.07].map(
    (lateral) => say({ driver: "program", topic: "", speed: [0.2, 0, lateral] }).text,
  );
  assert.equal(left?.replaceAll("\u00A0", " "), "a program drives: 0.20 m/s, 0.07 m/s to the left, 0.00 rad/s");
  assert.equal(right?.replaceAll("\u00A0", " "), "a program drives: 0.20 m/s, 0.07 m/s to the right, 0.00 rad/s");
  assert.equal(say({ speed: [0, 0, 0.1] }).text, "stopping");
  assert.equal(say({ ready: false, cause: "the feed is closed" }).text, "the feed is closed");
  assert.equal(say({ status: "/cmd_vel has no subscriber" }).hint, "/cmd_vel has no subscriber");
  assert.equal(say({ driver: "program" }, { silence: SILENT }).text, SILENT);
  assert.deepEqual(say({ driver: "program" }, { hasKernel: false }), {
    text: "no kernel in this page",
    hint: "Stop reaches nothing; what the robot does is not known",
    kind: "warn",
  });
});

test("the bar shows before Stop is pressed if it can interrupt a busy kernel", () => {
  assert.equal(say({}, { hears: false }).hint, "kernel busy: Stop interrupts the cell");
  assert.equal(say({}, { hears: false, canInterrupt: false }).hint, "kernel busy: Stop cannot reach it");
});

test("only a stop that Python confirmed is shown as stopped", () => {
  const text = (note: Note, stopped: boolean) => say({ stopped, driver: stopped ? "" : "program" }, { note }).text;
  assert.equal(text("asking", false), "stopping");
  assert.equal(say({ driver: "program" }, { note: "asking", silence: SILENT }).text, SILENT);
  assert.equal(text("interrupted", false), "stopping");
  assert.equal(text("ignored", false), "the kernel was interrupted, but does not answer");
  assert.equal(text("unreachable", false), "Stop cannot reach the busy kernel");
  assert.equal(text("", true), "nobody may drive");
  assert.equal(say({ stopped: true, speed: [0.2, 0, 0] }).text, "stopping", "zero was not sent yet");
  assert.equal(say({ stopped: true }, { note: "refused" }).hint, "Allow came too late: press it again");
});

test("a bar begins at zero and ends at the limit", () => {
  assert.deepEqual(toBar(0.25, 0.5), { left: "50%", width: "25%" });
  assert.deepEqual(toBar(-0.25, 0.5), { left: "25%", width: "25%" });
  assert.deepEqual(toBar(9, 0.5), { left: "50%", width: "50%" });
});
