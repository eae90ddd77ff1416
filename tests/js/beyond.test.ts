import assert from "node:assert/strict";
import { test } from "node:test";
import { dotSize, drawBeyond } from "../../robowidgets/js/laser/draw_readings.ts";
import type { Theme } from "../../robowidgets/js/shared/theme.ts";

const BOX = { x: 0, y: 0, width: 210, height: 190 };

/** The place of the words, or undefined if they are left out. */
function written(labelBoxes: (typeof BOX)[]): { x: number; y: number } | undefined {
  let at: { x: number; y: number } | undefined;
  const context = {
    measureText: () => ({ width: 90 }),
    fillText: (_: string, x: number, y: number) => {
      at = { x, y };
    },
  };
  const any = new Proxy(context, { get: (own, name) => Reflect.get(own, name) ?? (() => {}) });
  drawBeyond(
    any as unknown as CanvasRenderingContext2D,
    "134 beyond 1.5 m",
    { box: BOX, labels: labelBoxes },
    {} as Theme,
  );
  return at;
}

test("the number of readings beyond the view stands in a corner without labels, and is left out without one", () => {
  const label = (x: number, y: number) => ({ x, y, width: 50, height: 26 });
  assert.deepEqual(written([]), { x: 22, y: 175.5 });
  assert.deepEqual(written([label(30, 160)]), { x: 22, y: 15.5 });
  assert.equal(written([label(30, 160), label(30, 0), label(140, 160), label(140, 0)]), undefined);
});

test("a few dots are drawn larger", () => {
  const sizes = [1, 16, 24, 60, 120, 180, 181, 1040].map((rays) => dotSize(rays, rays, 30));
  assert.deepEqual(sizes, [6, 6, 5, 5, 4, 4, 3, 3]);
  assert.equal(dotSize(1040, 3, 1), 6, "few readings of many rays");
  assert.equal(dotSize(1040, 17, 1), 3, "the number of rays does not change from scan to scan");
  assert.deepEqual(
    [18, 16, 8].map((spacing) => dotSize(19, 19, spacing)),
    [4, 4, 3],
    "they do not run together",
  );
});
