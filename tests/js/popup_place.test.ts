import assert from "node:assert/strict";
import { test } from "node:test";
import { thinLabels } from "../../robowidgets/js/laser/guides.ts";
import type { Box, Point } from "../../robowidgets/js/shared/box.ts";
import { overlaps } from "../../robowidgets/js/shared/box.ts";
import { angleOf, type Sweep } from "../../robowidgets/js/shared/frames/scan.ts";
import { Occupancy } from "../../robowidgets/js/shared/occupancy.ts";
import { crosses, placePopup } from "../../robowidgets/js/shared/popup_place.ts";
import { rimBox, toPixel } from "../../robowidgets/js/shared/projection.ts";
import { BOXES, layOut, randoms, SWEEPS } from "./laser.ts";

/** From a short reading to the longest words, as a browser measures them: the style sheet allows less than half. */
function sizesIn({ width, height }: Box) {
  const most = { width: width / 2 - 8, height: height / 2 - 8 };
  return [
    { width: Math.min(148, most.width), height: 74 },
    { width: Math.min(236, most.width), height: 74 },
    { width: Math.min(350, most.width), height: Math.min(98, most.height) },
  ];
}
const NOTHING = new Occupancy(1, 1);

function isInside(box: Box, { x, y }: Point, { width, height }: { width: number; height: number }): boolean {
  return x >= box.x && y >= box.y && x + width <= box.x + box.width && y + height <= box.y + box.height;
}

for (const [name, sweep] of Object.entries(SWEEPS)) {
  for (const box of BOXES) {
    test(`${name}, ${box.width} x ${box.height}: in the box and off the ray, for every ray`, () => {
      const { projection, labels } = layOut(sweep, box);
      const labelBoxes = thinLabels(projection, labels).map((label) => rimBox(projection, label));
      const center = { x: projection.centerX, y: projection.centerY };
      const random = randoms(11);
      const occupied = new Occupancy(box.width, box.height + box.y);
      const ends = Array.from({ length: sweep.count }, (_, i) => toPixel(projection, 10 * random(), angleOf(sweep, i)));
      for (const { x, y } of ends) occupied.mark(x, y);
      const step = Math.max(1, Math.floor(sweep.count / 40));
      for (let i = 0; i < sweep.count; i += step) {
        for (const end of [ends[i] as Point, toPixel(projection, 10, angleOf(sweep, i))]) {
          for (const size of sizesIn(box)) {
            const place = placePopup(size, box, center, end, occupied, [], labelBoxes);
            assert.ok(isInside(box, place, size), `ray ${i}: outside`);
            assert.ok(!crosses(center, end, { ...place, ...size }), `ray ${i}: covers its ray`);
          }
        }
      }
    });
  }
}

test("with room, it stands near its ray", () => {
  const box = { x: 0, y: 0, width: 1200, height: 800 };
  const size = { width: 148, height: 74 };
  for (let degrees = 0; degrees < 360; degrees += 5) {
    const [from, angle] = [{ x: 600, y: 400 }, (degrees * Math.PI) / 180];
    const to = { x: 600 + 250 * Math.cos(angle), y: 400 - 250 * Math.sin(angle) };
    const { x, y } = placePopup(size, box, from, to, NOTHING, [], []);
    const away = Math.hypot(
      Math.max(x - to.x, 0, to.x - x - size.width),
      Math.max(y - to.y, 0, to.y - y - size.height),
    );
    assert.ok(away < 40, `${degrees} degrees: ${away} pixels away`);
  }
});

test("it avoids another pop-up, labels and readings if it can", () => {
  const box = { x: 0, y: 0, width: 800, height: 600 };
  const size = { width: 148, height: 74 };
  const [from, to] = [
    { x: 400, y: 500 },
    { x: 400, y: 300 },
  ];
  const alone = placePopup(size, box, from, to, NOTHING, [], []);
  const taken = { ...alone, ...size };
  const second = placePopup(size, box, from, to, NOTHING, [taken], []);
  assert.ok(!overlaps({ ...second, ...size }, taken));
  const third = placePopup(size, box, from, to, NOTHING, [], [taken]);
  assert.ok(!overlaps({ ...third, ...size }, taken));
  const dots = new Occupancy(800, 600);
  for (let x = taken.x; x < taken.x + size.width; x += 6) dots.mark(x, taken.y + 30);
  const fourth = placePopup(size, box, from, to, dots, [], []);
  assert.equal(dots.count({ ...fourth, ...size }), 0);
});

test("it avoids the data if the picture has room elsewhere", () => {
  const [box, size] = [BOXES[2] as Box, { width: 160, height: 74 }];
  const sweep = SWEEPS["270 degrees"] as Sweep;
  const { projection, labels } = layOut(sweep, box);
  const labelBoxes = thinLabels(projection, labels).map((label) => rimBox(projection, label));
  const center = { x: projection.centerX, y: projection.centerY };
  // A room: walls around, and clutter in the right half.
  const random = randoms(3);
  const ends = Array.from({ length: sweep.count }, (_, i) =>
    toPixel(projection, i < 500 ? 4 + 4 * random() : 8, angleOf(sweep, i)),
  );
  const dots = new Occupancy(box.width, box.height);
  for (const { x, y } of ends) dots.mark(x, y);
  for (let i = 0; i < sweep.count; i += 20) {
    const place = placePopup(size, box, center, ends[i] as Point, dots, [], labelBoxes);
    // Of 324 cells, one may be touched at the edge.
    assert.ok(dots.count({ ...place, ...size }) <= 1, `ray ${i}`);
  }
});

test("a line crosses a box when it touches it anywhere, and not when it ends before", () => {
  const box = { x: 10, y: 10, width: 20, height: 10 };
  const cases: [Point, Point, boolean][] = [
    [{ x: 0, y: 15 }, { x: 50, y: 15 }, true],
    [{ x: 0, y: 15 }, { x: 9, y: 15 }, false],
    [{ x: 15, y: 0 }, { x: 15, y: 50 }, true],
    [{ x: 5, y: 0 }, { x: 5, y: 50 }, false],
    [{ x: 0, y: 0 }, { x: 40, y: 40 }, true],
    [{ x: 0, y: 25 }, { x: 5, y: 0 }, false],
    [{ x: 12, y: 12 }, { x: 14, y: 14 }, true],
    [{ x: 15, y: 15 }, { x: 15, y: 15 }, true],
    [{ x: 5, y: 15 }, { x: 5, y: 15 }, false],
    [{ x: 0, y: 20 }, { x: 12, y: 32 }, false],
  ];
  for (const [a, b, expected] of cases) {
    assert.equal(crosses(a, b, box), expected, `${a.x},${a.y} to ${b.x},${b.y}`);
    assert.equal(crosses(b, a, box), expected, `${b.x},${b.y} to ${a.x},${a.y}`);
  }
});
