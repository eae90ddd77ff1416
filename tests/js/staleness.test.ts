import assert from "node:assert/strict";
import { test } from "node:test";
import {
  BEAT_MS,
  KERNEL_SILENT_MS,
  listedSilentAfter,
  SCAN_GAP_STEPS,
  silentAfter,
  usualStep,
} from "../../robowidgets/js/shared/staleness.ts";
import { toNumber, vectors } from "./vectors.ts";

test("a source is silent by Python's rules, on show and in a list", () => {
  for (const [step, onShow, listed] of vectors.silences) {
    assert.equal(silentAfter(1000 * toNumber(step)), 1000 * onShow);
    assert.equal(listedSilentAfter(1000 * toNumber(step)), 1000 * toNumber(listed));
  }
});

test("the usual step is the median of the steps forward in time", () => {
  for (const [times, step] of vectors.steps) assert.equal(usualStep(times), toNumber(step));
});

test("one lost beat makes neither the kernel silent to the page, nor the page to the kernel", () => {
  assert.ok(KERNEL_SILENT_MS >= 2 * 1000 * vectors.beats.beat);
  assert.ok(1000 * vectors.beats.page >= 2 * BEAT_MS);
});

test("a scanogram has the same gaps in an exported page", () => {
  assert.equal(SCAN_GAP_STEPS, vectors.beats["scan gap"]);
});
