import assert from "node:assert/strict";
import { test } from "node:test";
import { StopView } from "../../robowidgets/js/stop/view.ts";
import { clock, document } from "./looks/page.ts";
import { FakeModel } from "./models.ts";
import { told } from "./stop.ts";

function open(signal: AbortSignal) {
  const model = new FakeModel({ _state: told(), _together: "", _robot: "", _view: "", _black_box: "", _opens: false });
  const element = document.createElement("div");
  document.body.append(element);
  new StopView(model.model, element, signal);
  return { model, notice: () => element.querySelector(".rw-notice")?.textContent };
}

test("a bar that is made while the page prints is complete when it is drawn, and draws changes on the paper", async () => {
  const errors: unknown[] = [];
  Object.assign(globalThis, { reportError: (error: unknown) => errors.push(error) });
  const end = new AbortController();
  open(end.signal); // with the first bar, the page learns of prints
  document.documentElement.classList.add("rw-printing");
  const { model, notice } = open(end.signal);
  await Promise.resolve();
  assert.deepEqual(errors, []);
  model.receive({ _state: told({ error: "no speeds" }) });
  await Promise.resolve();
  assert.equal(notice(), "no speeds");
  document.documentElement.classList.remove("rw-printing");
  end.abort();
  await clock.pass(100);
});
