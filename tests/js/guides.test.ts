import assert from "node:assert/strict";
import { test } from "node:test";
import { type ArcLabel, arcDistances, arcLabels, rayIndices, thinLabels } from "../../robowidgets/js/laser/guides.ts";
import { overlaps } from "../../robowidgets/js/shared/box.ts";
import { angleOf, indexAt, type Sweep } from "../../robowidgets/js/shared/frames/scan.ts";
import { Occupancy } from "../../robowidgets/js/shared/occupancy.ts";
import { type Projection, rimBox, toPixel } from "../../robowidgets/js/shared/projection.ts";
import { BOXES, circle, DEGREE, layOut, near, randoms, SWEEPS, sweepOf } from "./laser.ts";

/** A scanner of a robot, whose last ray is one step short of the same angle as its first. */
const PR2 = { angleMin: -130 * DEGREE, angleIncrement: DEGREE / 4, count: 1040 };

test("a count of arcs divides the view in equal parts, the last arc at its edge", () => {
  assert.deepEqual(arcDistances([], 4, 10), [2.5, 5, 7.5, 10]);
  assert.deepEqual(arcDistances([], 1, 5.6), [5.6]);
  assert.deepEqual(arcDistances([], 0, 10), []);
  for (const count of [3, 7, 50]) assert.equal(arcDistances([], count, 5.6).length, count, "rounding loses none");
});

test("arcs at given distances stand there, within the view", () => {
  assert.deepEqual(arcDistances([4, 0.5, 12], 7, 10), [0.5, 4]);
  assert.deepEqual(arcDistances([10], 7, 10), [10]);
  const asked = [3, 1, 2];
  arcDistances(asked, 0, 10);
  assert.deepEqual(asked, [3, 1, 2], "the trait itself is left alone");
});

test("without a count, two to six arcs stand at steps of 1, 2 or 5", () => {
  assert.deepEqual(arcDistances([], null, 10), [2, 4, 6, 8, 10]);
  assert.deepEqual(arcDistances([], null, 5.6), [1, 2, 3, 4, 5]);
  assert.deepEqual(arcDistances([], null, 3.5), [1, 2, 3]);
  assert.deepEqual(arcDistances([], null, 1), [0.2, 0.4, 0.6, 0.8, 1]);
  assert.deepEqual(arcDistances([], null, 0.003), [0.001, 0.002, 0.003]);
  assert.deepEqual(arcDistances([], null, 80), [20, 40, 60, 80]);
  for (let range = 0.05; range < 100_000; range *= 1.03) {
    const arcs = arcDistances([], null, range);
    assert.ok(arcs.length >= 2 && arcs.length <= 6, `${range}`);
    assert.match(String(Number((arcs[0] as number).toExponential(0))), /^[0.]*[125]0*$/);
  }
});

/** The angles of radial lines in degrees. */
const degreesOf = (sweep: Sweep, indices: number[]) =>
  indices.map((index) => Math.round((angleOf(sweep, index) / DEGREE) * 10) / 10);

const linesOf = (sweep: Sweep) => degreesOf(sweep, rayIndices(sweep, [], null));

test("without a count, lines stand at round angles from forward and at both ends", () => {
  assert.deepEqual(linesOf(sweepOf(180, 181)), [-90, -60, -30, 0, 30, 60, 90]);
  assert.deepEqual(linesOf(sweepOf(270, 1081)), [-135, -90, -45, 0, 45, 90, 135]);
  assert.deepEqual(linesOf(sweepOf(240, 961)), [-120, -90, -60, -30, 0, 30, 60, 90, 120]);
  assert.deepEqual(linesOf(PR2), [-130, -120, -90, -60, -30, 0, 30, 60, 90, 120, 129.8]);
  assert.deepEqual(linesOf(circle()), [-180, -135, -90, -45, 0, 45, 90, 135]);
  assert.deepEqual(linesOf(circle(360, 0)), [0, 45, 90, 135, 180, 225, 270, 315]);
  assert.deepEqual(
    linesOf({ angleMin: -45 * DEGREE, angleIncrement: DEGREE / 2, count: 541 }),
    [-45, 0, 45, 90, 135, 180, 225],
  );
  assert.deepEqual(linesOf(sweepOf(60, 61, 60)), [60, 70, 80, 90, 100, 110, 120], "forward is not swept");
});

test("a few rays still have lines at equal angles", () => {
  assert.deepEqual(linesOf(sweepOf(180, 19)), [-90, -60, -30, 0, 30, 60, 90]);
  assert.deepEqual(linesOf(sweepOf(120, 7)), [-60, -40, -20, 0, 20, 40, 60]);
  assert.deepEqual(linesOf(circle(16, 0)), [0, 45, 90, 135, 180, 225, 270, 315]);
  assert.deepEqual(linesOf(circle(20, 0)), [0, 36, 72, 108, 144, 180, 216, 252, 288, 324]);
  assert.deepEqual(rayIndices(sweepOf(60, 5), [], null), [0, 1, 2, 3, 4]);
});

test("whenever forward is swept, a line stands ahead", () => {
  const sweeps = Object.entries({ ...SWEEPS, PR2, "an uneven one": sweepOf(200, 401, -61) });
  for (const [name, sweep] of sweeps) {
    const ahead = indexAt(sweep, 0);
    for (const count of [null, 1]) {
      assert.ok(ahead < 0 || rayIndices(sweep, [], count).includes(ahead), `${name}, ${count}`);
    }
  }
});

test("a count of lines divides the swept angle in equal parts, ends included", () => {
  assert.deepEqual(rayIndices(sweepOf(180, 181), [], 5), [0, 45, 90, 135, 180]);
  assert.deepEqual(rayIndices(sweepOf(180, 181), [], 4), [0, 60, 120, 180]);
  assert.deepEqual(rayIndices(sweepOf(270, 1081), [], 2), [0, 1080]);
  assert.deepEqual(degreesOf(PR2, rayIndices(PR2, [], 9)), [-130, -97.5, -65, -32.5, 0, 32.5, 65, 97.5, 129.8]);
});

test("on a full circle the ends meet, so that one line stands for both", () => {
  for (const sweep of [circle(), circle(360, 0), SWEEPS["360 degrees clockwise"] as Sweep]) {
    assert.deepEqual(rayIndices(sweep, [], 4), [0, 90, 180, 270]);
    assert.deepEqual(rayIndices(sweep, [], 8), [0, 45, 90, 135, 180, 225, 270, 315]);
  }
});

test("on a full circle a line stands ahead, at any start of the scanner", () => {
  for (const first of [-180, -90, 0, 90]) {
    for (const count of [4, 9]) {
      const indices = rayIndices(circle(360, first), [], count);
      assert.ok(indices.includes(indexAt(circle(360, first), 0)), `${count} lines from ${first} degrees`);
      assert.equal(indices.length, count);
    }
  }
});

test("a repeated end ray leaves the parts of a circle equal", () => {
  assert.deepEqual(rayIndices(sweepOf(360, 361), [], 4), [0, 90, 180, 270]);
  assert.equal(rayIndices(sweepOf(360, 361), [], 360).length, 360);
});

test("without rays or with a count of zero there are no lines", () => {
  assert.deepEqual(rayIndices(sweepOf(180, 181), [], 1), [90]);
  assert.deepEqual(rayIndices(sweepOf(60, 61, 60), [], 1), [30], "forward is not swept");
  assert.deepEqual(rayIndices(sweepOf(180, 181), [], 0), []);
  assert.deepEqual(rayIndices({ angleMin: 0, angleIncrement: 0.1, count: 0 }, [], null), []);
});

test("more lines than rays give each ray one line", () => {
  assert.deepEqual(rayIndices(sweepOf(60, 5), [], 360), [0, 1, 2, 3, 4]);
  assert.deepEqual(rayIndices(circle(4), [], 360), [0, 1, 2, 3]);
  assert.deepEqual(rayIndices(sweepOf(0, 1), [], 9), [0]);
});

test("lines at given angles stand at the closest rays, if there are any", () => {
  const asked = [30.4, -30, 0, 120, 0.2].map((degrees) => degrees * DEGREE);
  assert.deepEqual(linesOf({ ...sweepOf(180, 181) }).length, 7);
  assert.deepEqual(degreesOf(sweepOf(180, 181), rayIndices(sweepOf(180, 181), asked, 9)), [-30, 0, 30]);
});

test("a line's label is its angle over its index", () => {
  const { labels } = layOut(sweepOf(180, 181), BOXES[0], 10, "up", 5);
  assert.deepEqual(
    labels.map(({ lines }) => lines),
    [
      ["\u221290.0°", "[0]"],
      ["\u221245.0°", "[45]"],
      ["0.0°", "[90]"],
      ["45.0°", "[135]"],
      ["90.0°", "[180]"],
    ],
  );
});

test("labels are thinned until none overlaps; forward and both ends stay", () => {
  for (const [name, sweep] of Object.entries({ ...SWEEPS, PR2 })) {
    for (const box of BOXES) {
      for (const rayCount of [null, 1, 2, 5, 9, 24, 25, 90, 360]) {
        const { projection, labels } = layOut(sweep, box, 10, "up", rayCount);
        const kept = thinLabels(projection, labels);
        const boxes = kept.map((label) => rimBox(projection, label));
        for (const [i, one] of boxes.entries()) {
          for (const other of boxes.slice(i + 1)) assert.ok(!overlaps(one, other), `${name}, ${rayCount}`);
        }
        const indices = kept.map(({ index }) => index);
        const ahead = indexAt(sweep, 0);
        const isLine = labels.some(({ index }) => index === ahead);
        assert.ok(!isLine || indices.includes(ahead), `${name}, ${rayCount}: forward`);
        const spread = Math.abs(sweep.angleIncrement) * (sweep.count - 1);
        const ends = spread > 10 * DEGREE && spread < 320 * DEGREE && rayCount !== 1 ? [0, sweep.count - 1] : [];
        assert.ok(
          ends.every((end) => indices.includes(end)),
          `${name}, ${rayCount}: ends`,
        );
      }
    }
  }
});

test("only a label that is too close to an end's label gives way", () => {
  const { projection, labels } = layOut(PR2, BOXES[0], 10, "up", null);
  const kept = thinLabels(projection, labels).map(({ lines }) => lines[0]);
  assert.deepEqual(kept, [
    "\u2212130.0°",
    "\u221290.0°",
    "\u221260.0°",
    "\u221230.0°",
    "0.0°",
    "30.0°",
    "60.0°",
    "90.0°",
    "129.8°",
  ]);
});

test("labels are thinned on both sides alike", () => {
  const turn = (angle: number) => Math.atan2(Math.sin(angle), Math.cos(angle));
  for (const [name, sweep] of Object.entries({ ...SWEEPS, PR2 })) {
    const isAlike =
      Math.abs(turn(sweep.angleMin + angleOf(sweep, sweep.count - 1))) < 1.5 * Math.abs(sweep.angleIncrement);
    if (!isAlike || name === "one ray") continue;
    for (const box of [...BOXES, { x: 0, y: 0, width: 226, height: 226 }, { x: 0, y: 0, width: 260, height: 260 }]) {
      for (const rayCount of [null, 5, 8, 9, 12, 24, 25, 90, 360]) {
        const { projection, labels } = layOut(sweep, box, 10, "up", rayCount);
        const kept = thinLabels(projection, labels).map(({ angle }) => turn(angle));
        const close = 2.5 * Math.abs(sweep.angleIncrement);
        const lone = kept.filter((angle) => !kept.some((other) => Math.abs(turn(angle + other)) < close));
        // Lines in equal parts from the first ray need not face each other, nor do those a few rays apart.
        const [first, second] = labels;
        const isDense = first && second && second.index - first.index < 6;
        const faces =
          !isDense && labels.every((one) => labels.some((other) => Math.abs(turn(one.angle + other.angle)) < close));
        if (faces) assert.deepEqual(lone, [], `${name}, ${rayCount}, ${box.width}`);
      }
    }
  }
});

test("labels that do not overlap all stay", () => {
  const { projection, labels } = layOut(circle(), BOXES[2], 10, "up", 8);
  assert.deepEqual(thinLabels(projection, labels), labels);
});

test("boxes overlap when they share more than an edge, with the margin asked for", () => {
  const box = { x: 10, y: 10, width: 10, height: 10 };
  assert.equal(overlaps(box, { x: 20, y: 10, width: 5, height: 5 }), false);
  assert.equal(overlaps(box, { x: 20, y: 10, width: 5, height: 5 }, 2), true);
  assert.equal(overlaps(box, { x: 19, y: 19, width: 50, height: 50 }), true);
  assert.equal(overlaps(box, { x: 12, y: 12, width: 1, height: 1 }), true);
  assert.equal(overlaps(box, { x: 12, y: 21, width: 1, height: 1 }), false);
});

test("marked cells are occupied, and cells outside the picture are ignored", () => {
  const occupied = new Occupancy(100, 50);
  for (const [x, y] of [
    [-1, 5],
    [5, -1],
    [500, 5],
    [5, 500],
    [Number.NaN, 5],
  ] as const)
    occupied.mark(x, y);
  assert.equal(occupied.count({ x: -50, y: -50, width: 1000, height: 1000 }), 0);
  occupied.mark(30, 20);
  occupied.mark(30.5, 20.5);
  assert.equal(occupied.count({ x: 28, y: 18, width: 10, height: 10 }), 1);
  assert.equal(occupied.count({ x: 50, y: 18, width: 10, height: 10 }), 0);
  occupied.mark(99, 49);
  assert.equal(occupied.count({ x: 0, y: 0, width: 100, height: 50 }), 2);
});

const WIDTH = 40;

interface Picture {
  sweep: Sweep;
  projection: Projection;
  arcs: { distance: number; width: number }[];
  lines: number[];
  box: (typeof BOXES)[number];
}

function picture(sweep: Sweep, box = BOXES[2] as (typeof BOXES)[number]): Picture {
  const { projection } = layOut(sweep, box);
  const lines = rayIndices(sweep, [], 9).map((index) => angleOf(sweep, index));
  return {
    sweep,
    projection,
    arcs: arcDistances([], 4, 10).map((distance) => ({ distance, width: WIDTH })),
    lines,
    box,
  };
}

const label = (p: Picture, occupied = new Occupancy(p.box.width, p.box.height), previous: ArcLabel[] = []) =>
  arcLabels(p.projection, p.sweep, p.arcs, p.lines, occupied, [], previous);

test("in an empty picture every arc is labelled, inside it and inside the swept angle", () => {
  for (const [name, sweep] of Object.entries(SWEEPS)) {
    const p = picture(sweep);
    const labels = label(p);
    assert.deepEqual(
      labels.map(({ distance }) => distance),
      [2.5, 5, 7.5, 10],
      name,
    );
    for (const { distance, angle, box } of labels) {
      const corners = [box.x, box.x + box.width].flatMap((x) => [box.y, box.y + box.height].map((y) => ({ x, y })));
      const arc = toPixel(p.projection, distance, angle);
      const pixels = (distance / 10) * p.projection.radius;
      for (const { x, y } of corners) {
        const along =
          (x - p.projection.centerX) * (arc.x - p.projection.centerX) +
          (y - p.projection.centerY) * (arc.y - p.projection.centerY);
        assert.ok(along / pixels <= pixels - 1, name);
        assert.ok(x >= 0 && x <= p.box.width && y >= 0 && y <= p.box.height, `${name}: cut by the edge`);
      }
      if (sweep.count > 1) assert.notEqual(indexAt(sweep, angle), -1, name);
    }
  }
});

test("a label is twice as close to its arc as to any other, or lies on it and on no other", () => {
  let onArc = 0;
  for (const [name, sweep] of Object.entries(SWEEPS)) {
    for (const side of [120, 160, 200, 226, 260, 320, 500, 760]) {
      const box = { x: 0, y: 0, width: side, height: side };
      const { projection } = layOut(sweep, box);
      for (const count of [2, 3, 5, 6]) {
        const arcs = arcDistances([], count, 10).map((distance) => ({ distance, width: WIDTH }));
        const toPixels = (distance: number) => (distance / 10) * projection.radius;
        for (const { distance, box: label } of arcLabels(
          projection,
          sweep,
          arcs,
          [],
          new Occupancy(side, side),
          [],
          [],
        )) {
          const [x, y] = [
            label.x + label.width / 2 - projection.centerX,
            label.y + label.height / 2 - projection.centerY,
          ];
          const pixels = Math.hypot(x, y);
          const own = Math.abs(pixels - toPixels(distance));
          const half = (Math.abs(x / pixels) * label.width + Math.abs(y / pixels) * label.height) / 2;
          const others = arcs.filter((arc) => arc.distance !== distance);
          const other = Math.min(...others.map((arc) => Math.abs(pixels - toPixels(arc.distance))));
          if (own < 0.01) onArc += 1;
          assert.ok(own < 0.01 ? other > half : other > 1.99 * own, `${name}, ${side}, ${count}: ${distance} m`);
        }
      }
    }
  }
  assert.ok(onArc > 0, "some lie on their arcs");
});

test("the edge never cuts the labels of one ray, at any angle", () => {
  for (let degrees = -180; degrees <= 180; degrees += 5) {
    const sweep = { angleMin: (degrees * Math.PI) / 180, angleIncrement: 0, count: 1 };
    const p = { ...picture(sweep), projection: layOut(sweep, BOXES[2], 10, "up", 0).projection };
    const labels = label({ ...p, arcs: p.arcs.map(({ distance }) => ({ distance, width: 60 })), lines: [] });
    assert.ok(labels.length >= 3, `${degrees}`);
    for (const { box } of labels) {
      assert.ok(box.x >= 0 && box.x + box.width <= p.box.width, `${degrees}`);
      assert.ok(box.y >= 0 && box.y + box.height <= p.box.height, `${degrees}`);
    }
  }
});

test("labels stand left of forward", () => {
  for (const sweep of [circle(), circle(360, 0), SWEEPS["360 degrees clockwise"] as Sweep, sweepOf(270, 1081)]) {
    for (const { angle } of label(picture(sweep))) {
      const turned = Math.atan2(Math.sin(angle), Math.cos(angle));
      assert.ok(turned > 0 && turned < 0.6, `${turned}`);
    }
  }
});

test("a label never stands on a reading, on another label, or on an element over the picture", () => {
  const random = randoms(7);
  for (const sweep of Object.values(SWEEPS)) {
    const p = picture(sweep);
    for (let round = 0; round < 20; round++) {
      const occupied = new Occupancy(p.box.width, p.box.height);
      const dots = Array.from({ length: sweep.count }, (_, i) =>
        toPixel(p.projection, 10 * random() ** 0.5, angleOf(sweep, i)),
      );
      for (const { x, y } of dots) occupied.mark(x, y);
      const covered = [{ x: random() * 600, y: random() * 400, width: 200, height: 80 }];
      const labels = arcLabels(p.projection, p.sweep, p.arcs, p.lines, occupied, covered, []);
      for (const [i, { box }] of labels.entries()) {
        for (const { x, y } of dots) assert.ok(!overlaps(box, { x, y, width: 0, height: 0 }));
        for (const other of [...labels.slice(i + 1).map((l) => l.box), ...covered]) assert.ok(!overlaps(box, other));
      }
    }
  }
});

test("a label keeps its place as long as that is free", () => {
  const p = picture(sweepOf(270, 1081));
  const first = label(p);
  const blocking = new Occupancy(p.box.width, p.box.height);
  for (const { box } of first) blocking.mark(box.x + box.width / 2, box.y + box.height / 2);
  const second = label(p, blocking, first);
  assert.equal(second.length, 4);
  for (const [i, { angle }] of second.entries()) assert.notEqual(angle, first[i]?.angle);
  const third = label(p, undefined, second);
  assert.deepEqual(
    third.map(({ angle }) => angle),
    second.map(({ angle }) => angle),
    "it does not jump back",
  );
});

test("a label leaves a place that the sweep no longer reaches", () => {
  const before = label(
    picture(circle()),
    undefined,
    [10, 7.5, 5, 2.5].map((distance) => ({
      distance,
      angle: 150 * DEGREE,
      box: { x: 0, y: 0, width: 0, height: 0 },
    })),
  );
  assert.ok(before.every(({ angle }) => near(angle, 150 * DEGREE)));
  for (const { angle } of label(picture(sweepOf(60, 61)), undefined, before)) assert.ok(Math.abs(angle) < 30 * DEGREE);
});

test("an arc close to the robot has no label", () => {
  const p = { ...picture(circle()), arcs: [{ distance: 0.1, width: WIDTH }] };
  assert.deepEqual(label(p), []);
});

test("on a circle that is nearly closed only the last label gives way to the first", () => {
  for (const sweep of [sweepOf(358, 359), sweepOf(357, 358), sweepOf(357.5, 719)]) {
    const { projection, labels } = layOut(sweep, BOXES[2], 10, "up", 9);
    assert.deepEqual(thinLabels(projection, labels), labels.slice(0, 8));
  }
});
