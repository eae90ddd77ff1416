import assert from "node:assert/strict";
import { afterEach, beforeEach, test } from "node:test";
import { Credit } from "../../robowidgets/js/shared/credit.ts";
import { FakeModel } from "./models.ts";

/** Callbacks that wait for an animation frame. */
let waiting = new Map<number, () => void>();
const page = globalThis as { requestAnimationFrame?: unknown; cancelAnimationFrame?: unknown };

beforeEach(() => {
  waiting = new Map();
  page.requestAnimationFrame = (call: () => void) => waiting.set(waiting.size + 1, call).size;
  page.cancelAnimationFrame = (number: number) => waiting.delete(number);
});

afterEach(() => {
  delete page.requestAnimationFrame;
  delete page.cancelAnimationFrame;
});

function frame(sequence: number): DataView {
  const bytes = new DataView(new ArrayBuffer(32));
  bytes.setFloat64(0, sequence, true);
  return bytes;
}

interface Answer {
  drawn: number;
  page: string;
  lacks?: number;
}

function open(values: Record<string, unknown> = {}) {
  const answers: Answer[] = [];
  const fake = new FakeModel({ _answers: true, _frame: frame(0), ...values });
  const model = Object.assign(fake, { send: (answer: Answer) => answers.push(answer) }).model;
  const controller = new AbortController();
  const credit = new Credit(model, controller.signal);
  return { fake, credit, answers, controller };
}

test("each frame is answered once, for any number of views that have drawn it", () => {
  const { fake, credit, answers } = open();
  for (const number of [1, 1, 2]) {
    fake.receive({ _frame: frame(number) });
    credit.drawn();
    credit.drawn();
  }
  assert.deepEqual(
    answers.map(({ drawn }) => drawn),
    [1, 1, 2],
  );
  assert.equal(new Set(answers.map((answer) => answer.page)).size, 1);
});

test("a page announces itself before the first frame, and all pages have different names", () => {
  const [one, other] = [open({ _frame: null }), open({ _frame: null })];
  one.credit.drawn();
  one.credit.drawn();
  other.credit.drawn();
  assert.deepEqual(
    one.answers.map(({ drawn }) => drawn),
    [0],
  );
  assert.notEqual(one.answers[0]?.page, other.answers[0]?.page);
});

test("on request, a page reports in its next animation frame what it has drawn and if the last one arrived", () => {
  const { fake, credit, answers } = open();
  fake.receive({ _frame: frame(4) });
  credit.drawn();
  fake.receive({ _frame: frame(5) });
  for (const asks of [5, 6]) {
    fake.tell({ asks });
    fake.tell({ asks });
    fake.tell({ other: 1 });
    assert.equal(waiting.size, 1);
    for (const call of waiting.values()) call();
    waiting.clear();
  }
  assert.deepEqual(
    answers.map(({ drawn, lacks }) => [drawn, lacks]),
    [
      [4, undefined],
      [4, undefined],
      [4, 6],
    ],
  );
});

test("a frame that was decoded late is answered as itself", () => {
  const { fake, credit, answers } = open();
  fake.receive({ _frame: frame(1) });
  const { newest } = credit;
  fake.receive({ _frame: frame(2) });
  credit.drawn(newest);
  assert.deepEqual(
    answers.map(({ drawn }) => drawn),
    [1],
  );
});

test("a player and an exported page do not answer", () => {
  for (const values of [{ _answers: false }, { layout: { comm_live: false } }]) {
    const { credit, answers } = open(values);
    credit.drawn();
    assert.deepEqual(answers, []);
  }
});

test("a closed model leaves nothing behind", () => {
  const { fake, controller } = open();
  fake.tell({ asks: 1 });
  controller.abort();
  assert.equal(waiting.size, 0);
  assert.equal(fake.listening, 0);
});
