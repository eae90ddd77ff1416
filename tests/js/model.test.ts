import assert from "node:assert/strict";
import { test } from "node:test";
import { lacksKernel } from "../../robowidgets/js/shared/model.ts";
import { FakeModel } from "./models.ts";

test("a page lacks a kernel if the host's own models have no comm, and only then", () => {
  const lacks = (layout?: unknown) => lacksKernel(new FakeModel({ layout }).model);
  assert.equal(lacks({ comm_live: false }), true);
  assert.equal(lacks({ comm_live: true }), false);
  // Hosts that are not Jupyter hand out no model, or only its name.
  assert.deepEqual([lacks(), lacks(null), lacks("IPY_MODEL_1")], [false, false, false]);
});
