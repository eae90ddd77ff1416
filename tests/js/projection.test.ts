import assert from "node:assert/strict";
import { test } from "node:test";
import { sweepHeight } from "../../robowidgets/js/laser/guides.ts";
import { angleOf } from "../../robowidgets/js/shared/frames/scan.ts";
import { FORWARD, fromPixel, rimBox, toPixel } from "../../robowidgets/js/shared/projection.ts";
import { BOXES, DEGREE, layOut, near, SWEEPS, sweepOf } from "./laser.ts";

const FORWARDS = ["up", "left", "down", "right"];
const ROBOT = 9;

for (const [name, sweep] of Object.entries(SWEEPS)) {
  for (const forward of FORWARDS) {
    test(`${name}, forward ${forward}: labels, rim and robot lie in the box`, () => {
      for (const box of BOXES) {
        for (const rayCount of [0, 1, 9, 30]) {
          const { projection, labels } = layOut(sweep, box, 10, forward, rayCount);
          const where = `${box.width} x ${box.height}, ${rayCount} lines`;
          const inside = (left: number, top: number, right: number, bottom: number) =>
            left >= box.x && top >= box.y && right <= box.x + box.width && bottom <= box.y + box.height;
          for (const label of labels) {
            const { x, y, width, height } = rimBox(projection, label);
            assert.ok(inside(x, y, x + width, y + height), `${where}: label ${label.lines.join(" ")}`);
          }
          for (let i = 0; i < sweep.count; i++) {
            const { x, y } = toPixel(projection, 10, angleOf(sweep, i));
            // Marks of rays without a reading stand up to 8 pixels beyond the rim.
            assert.ok(inside(x - 8, y - 8, x + 8, y + 8), `${where}: rim of ray ${i}`);
          }
          const { centerX: x, centerY: y } = projection;
          assert.ok(inside(x - ROBOT, y - ROBOT, x + ROBOT, y + ROBOT), `${where}: robot`);
          assert.ok(projection.radius >= 40, `${where}: a radius of ${projection.radius} pixels is too small`);
        }
      }
    });
  }
}

test("the picture is as large as it can be: it touches the box on two sides", () => {
  for (const sweep of Object.values(SWEEPS)) {
    const box = BOXES[2] as (typeof BOXES)[number];
    const { projection, labels } = layOut(sweep, box);
    const larger = { ...projection, radius: projection.radius * 1.02 };
    const boxes = (p: typeof projection) => labels.map((label) => rimBox(p, label));
    const rim = (p: typeof projection) =>
      Array.from({ length: sweep.count }, (_, i) => toPixel(p, 10, angleOf(sweep, i))).map(({ x, y }) => ({
        x: x - 8,
        y: y - 8,
        width: 16,
        height: 16,
      }));
    const robot = { x: projection.centerX - 16, y: projection.centerY - 16, width: 32, height: 32 };
    const span = (p: typeof projection) => {
      const all = [robot, ...boxes(p), ...rim(p)];
      const width = Math.max(...all.map((b) => b.x + b.width)) - Math.min(...all.map((b) => b.x));
      const height = Math.max(...all.map((b) => b.y + b.height)) - Math.min(...all.map((b) => b.y));
      return { width, height };
    };
    const { width, height } = span(larger);
    assert.ok(width > box.width - 12 || height > box.height - 12, "a larger one would fit too");
  }
});

test("forward up has left on the left, whichever way the scanner turns", () => {
  const right = { up: [1, 0], left: [0, -1], down: [-1, 0], right: [0, 1] };
  const ahead = { up: [0, -1], left: [-1, 0], down: [0, 1], right: [1, 0] };
  for (const forward of FORWARDS) {
    const { projection } = layOut(SWEEPS["360 degrees clockwise"] ?? sweepOf(360, 360), BOXES[0], 10, forward);
    const direction = (angle: number) => {
      const { x, y } = toPixel(projection, 10, angle);
      return [x - projection.centerX, y - projection.centerY].map((v) => Math.round(v / projection.radius) + 0);
    };
    const [dx = 0, dy = 0] = right[forward as "up"];
    assert.deepEqual(direction(0), ahead[forward as "up"]);
    assert.deepEqual(direction(-90 * DEGREE), [dx, dy]);
    assert.deepEqual(direction(90 * DEGREE), [0 - dx, 0 - dy]);
  }
});

test("metres are to scale", () => {
  const { projection } = layOut(sweepOf(180, 181), BOXES[2], 8);
  const { x, y } = toPixel(projection, 4, 0);
  assert.ok(near(x, projection.centerX));
  assert.ok(near(y, projection.centerY - projection.radius / 2));
});

test("a point of the picture converts back to its distance and angle", () => {
  for (const forward of FORWARDS) {
    for (const box of BOXES) {
      const { projection } = layOut(sweepOf(270, 271), box, 6, forward);
      for (let degrees = -179; degrees <= 180; degrees += 7) {
        for (const range of [0.01, 1, 5.9, 8]) {
          const back = fromPixel(projection, toPixel(projection, range, degrees * DEGREE));
          assert.ok(near(back.range, range, 1e-9));
          const off = Math.sin((back.angle - degrees * DEGREE) / 2);
          assert.ok(near(off, 0), `${degrees} degrees, forward ${forward}`);
        }
      }
    }
  }
});

test("an angle of more than a turn is the same place", () => {
  const { projection } = layOut(sweepOf(360, 361));
  const [a, b] = [toPixel(projection, 3, 0.5), toPixel(projection, 3, 0.5 + 2 * Math.PI)];
  assert.ok(near(a.x, b.x) && near(a.y, b.y));
});

test("a picture as high as its sweep needs has the same width as a higher one", () => {
  for (const [name, sweep] of Object.entries(SWEEPS)) {
    if (sweep.count < 10) continue;
    for (const forward of FORWARDS) {
      const { part, pixels } = sweepHeight(sweep, [], 9, FORWARD[forward] as number);
      for (const width of [320, 500, 760]) {
        const height = part * width + pixels;
        const radiusIn = (high: number) =>
          layOut(sweep, { x: 0, y: 0, width, height: high }, 10, forward).projection.radius;
        const widest = radiusIn(3 * width);
        const where = `${name}, forward ${forward}, ${width}: ${height}`;
        assert.ok(radiusIn(height) > 0.9 * widest || height > 0.76 * width, where);
        if (height < 0.76 * width) assert.ok(radiusIn(height - 40) < 0.99 * widest, where);
      }
    }
  }
});
