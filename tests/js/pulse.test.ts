import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { Pulse } from "../../robowidgets/js/shared/pulse.ts";
import { KERNEL_SILENT_MS } from "../../robowidgets/js/shared/staleness.ts";
import { FakeModel } from "./models.ts";

interface Traits {
  _beat: number;
}

function open(state: Record<string, unknown>) {
  mock.timers.reset();
  mock.timers.enable({ apis: ["setInterval"] });
  let now = 1000;
  const clock = mock.method(performance, "now", () => now);
  const fake = new FakeModel({ layout: { comm_live: true }, ...state });
  const end = new AbortController();
  const said: string[] = [];
  const isExpected = () => Number(fake.get("_beat")) > 0;
  const pulse: Pulse<Traits> = new Pulse(fake.model, ["_beat"], isExpected, () => said.push(pulse.words), end.signal);
  const pass = (ms: number) => {
    now += ms;
    mock.timers.tick(ms);
  };
  const close = () => {
    end.abort();
    assert.equal(fake.listening, 0);
    clock.mock.restore();
    mock.timers.reset();
  };
  return { fake, pulse, said, pass, close };
}

test("a kernel that sends no beat for a moment is silent, the text has its age, and the next beat ends it", () => {
  const { fake, pulse, said, pass, close } = open({ _beat: 7 });
  pass(KERNEL_SILENT_MS);
  assert.equal(pulse.words, "");
  assert.deepEqual(said, []);
  pass(2500);
  assert.equal(pulse.silence, 5000);
  assert.equal(said.at(-1), "no word from the kernel for 5.0 s");
  fake.receive({ _beat: 8 });
  assert.equal(pulse.silence, 0);
  pass(250);
  assert.equal(said.at(-1), "");
  close();
});

test("a kernel that has ended is silent at once, in a page that it once sent to", () => {
  const { fake, pulse, said, pass, close } = open({ _beat: 7 });
  pass(250);
  fake.receive({ layout: { comm_live: false } });
  pass(250);
  assert.ok(pulse.silence > 0);
  assert.deepEqual(said, ["no kernel in this page"]);
  close();
});

for (const [where, state] of [
  ["a widget that gets no beats", { _beat: 0 }],
  ["a page that was saved", { _beat: 7, layout: { comm_live: false } }],
] as const) {
  test(`nothing is silent in ${where}`, () => {
    const { pulse, said, pass, close } = open(state);
    pass(60_000);
    assert.equal(pulse.silence, 0);
    assert.equal(pulse.words, "");
    assert.deepEqual(said, []);
    close();
  });
}
