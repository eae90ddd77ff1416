import assert from "node:assert/strict";
import { test } from "node:test";
import { setFlagsFromString } from "node:v8";
import { runInNewContext } from "node:vm";
import { onAbort } from "../../robowidgets/js/shared/events.ts";

test("what is called back at the end is kept no longer than to the end, though the signal is", async () => {
  setFlagsFromString("--expose-gc");
  const { signal, ends, kept, controller } = open();
  assert.ok(kept.deref());
  controller.abort();
  assert.deepEqual(ends, ["first", "second"]);
  await new Promise((resolve) => setTimeout(resolve));
  runInNewContext("gc")();
  assert.equal(kept.deref(), undefined);
  assert.ok(signal.aborted);
});

function open() {
  const controller = new AbortController();
  const [ends, view]: [string[], { name: string }] = [[], { name: "second" }];
  onAbort(controller.signal, () => ends.push("first"));
  onAbort(controller.signal, () => ends.push(view.name));
  return { controller, signal: controller.signal, ends, kept: new WeakRef(view) };
}
