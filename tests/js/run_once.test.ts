import assert from "node:assert/strict";
import { test } from "node:test";
import { clock, document } from "./looks/page.ts";
import { FakeModel } from "./models.ts";

/** A model of a kernel that may have ended: JupyterLab then throws at each message. */
class KernelModel extends FakeModel {
  hasKernel = true;

  override send(content: unknown): void {
    if (!this.hasKernel) throw new Error("Cannot send");
    super.send(content);
  }
}

test("views that close with their kernel throw nothing, and a view of another kernel asks for the rest", async () => {
  // Node imports no blob.
  URL.createObjectURL = () => "data:text/javascript,export default { render() {} }";
  const { default: make } = await import("../../robowidgets/js/run_once.ts");
  const views = [];
  for (let i = 0; i < 3; i++) {
    const model = new KernelModel({ _script: "script", _style: "style" });
    const closing = new AbortController();
    const el = document.createElement("div");
    document.body.append(el);
    const given = { model, el, signal: closing.signal } as never;
    const widget = make();
    await widget.initialize(given);
    widget.render(given);
    views.push({ model, closing });
  }
  await clock.pass(1000);
  const [first, second, third] = views as [(typeof views)[0], (typeof views)[0], (typeof views)[0]];
  assert.deepEqual(first.model.sent, [{ later: true }]);
  first.model.hasKernel = second.model.hasKernel = false;
  const thrown: unknown[] = [];
  process.on("uncaughtException", (error) => thrown.push(error));
  first.closing.abort();
  second.closing.abort();
  await new Promise(setImmediate);
  assert.deepEqual(thrown, []);
  assert.deepEqual(third.model.sent, [{ later: true }]);
  third.model.hasKernel = false;
  third.closing.abort();
  await new Promise(setImmediate);
  assert.deepEqual(thrown, []);
});

test("a host without a notebook gets no pictures of it, and no error", async () => {
  URL.createObjectURL = () =>
    "data:text/javascript,export default { explainWords() {}, keepPictures() { throw new Error('no notebook') }, render() {} }";
  const { default: make } = await import("../../robowidgets/js/run_once.ts");
  const model = new KernelModel({ _script: "solara", _style: "style" });
  // As Solara has it.
  Object.assign(model, { widget_manager: { context: { sessionContext: { session: {} } } } });
  const el = document.createElement("div");
  document.body.append(el);
  const given = { model, el, signal: new AbortController().signal } as never;
  const widget = make();
  await widget.initialize(given);
  widget.render(given);
  await clock.pass(1000);
  model.tell({ later: "later" });
  await clock.pass(100);
});
