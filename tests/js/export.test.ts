import assert from "node:assert/strict";
import { test } from "node:test";
import { onRays, type Rays, raysAt } from "../../robowidgets/js/export/by_angle.ts";
import { toCsv } from "../../robowidgets/js/export/csv.ts";
import { Feed, Segments } from "../../robowidgets/js/export/feed.ts";
import { PageModel } from "../../robowidgets/js/export/model.ts";
import { momentOf, parseMoment, showMoment, toHash } from "../../robowidgets/js/export/moment.ts";
import { readPart } from "../../robowidgets/js/export/parts.ts";
import { Taker } from "../../robowidgets/js/export/taker.ts";
import { unpackTracks } from "../../robowidgets/js/export/tracks.ts";
import { decodeFrames, type TimedFrame } from "../../robowidgets/js/player/segments.ts";
import { frameOf, readsOf, vectors } from "./vectors.ts";

const NAMES = Object.keys(vectors.frames).filter((name) => name.startsWith("packed_"));

for (const name of NAMES) {
  test(`${name}: a page unpacks the bytes that Python has packed`, () => {
    const { facts, track } = readsOf(name);
    const packed = frameOf(name, 0);
    const bytes = new Uint8Array(packed.buffer.slice(0, packed.byteLength) as ArrayBuffer);
    const [made] = unpackTracks(facts, new Taker(bytes));
    assert.equal(Buffer.from((made as DataView).buffer).toString("base64"), track);
  });
}

for (const [i, [of, on, rays]] of vectors.rays.entries()) {
  test(`rays ${i} of another geometry stand at the same places as in Python`, () => {
    const [from, to] = [of, on].map(([angleMin, angleIncrement, count]) => ({ angleMin, angleIncrement, count }));
    assert.deepEqual([...raysAt(from as Rays, to as Rays)], rays);
  });
}

test("a scan keeps its rays, one with fewer rays is placed by angle, and one with more or without rays is left out", () => {
  const on = { angleMin: 0, angleIncrement: 0.5, count: 3 };
  const ranges = new Float32Array([1, 2, 3]);
  assert.equal(onRays(ranges, { ...on }, on), ranges);
  assert.deepEqual([...onRays(new Float32Array([1, 2]), { ...on, angleMin: 0.5, count: 2 }, on)], [NaN, 1, 2]);
  assert.deepEqual([...onRays(new Float32Array(4), { ...on, count: 4 }, on)], [NaN, NaN, NaN]);
  assert.deepEqual([...onRays(new Float32Array(0), { ...on, count: 0 }, on)], [NaN, NaN, NaN]);
});

function toBase85(bytes: Uint8Array): string {
  const digits = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz!#$%&()*+-;,=>?@^_`{|}~";
  const missing = (4 - (bytes.length % 4)) % 4;
  const padded = Buffer.concat([bytes, Buffer.alloc(missing)]);
  let text = "";
  for (let at = 0; at < padded.length; at += 4) {
    const number = padded.readUInt32BE(at);
    for (let power = 4; power >= 0; power--) text += digits[Math.floor(number / 85 ** power) % 85];
  }
  return text.slice(0, text.length - missing);
}

/** An element of a page with a packed segment, as Python writes it. */
async function partOf(
  number: number,
  times: number[],
  { size = 8, abouts = [{}] as object[], of = times.map(() => 0) } = {},
): Promise<HTMLElement> {
  const table = [times, of, times.map((_, i) => size * (i + 1))];
  const sorted = table.flatMap((column) => {
    const rows = column.map((value) => new Uint8Array(new Float64Array([value]).buffer));
    return Array.from({ length: 8 }, (_, place) => rows.map((row) => row[place] as number)).flat();
  });
  const count = times.length;
  const tracks = [{ count, bytes: size * count, abouts, table: [0, 1, 2] }];
  const text = new TextEncoder().encode(
    JSON.stringify({ segment: number, columns: table.map(() => [count, 0]), tracks }),
  );
  const all = [new Uint8Array(new Uint32Array([text.length]).buffer), text, Uint8Array.from(sorted)];
  const blob = new Blob([...all, new Uint8Array(size * times.length)]);
  const packed = await new Response(blob.stream().pipeThrough(new CompressionStream("deflate"))).arrayBuffer();
  return { textContent: toBase85(new Uint8Array(packed)) } as HTMLElement;
}

test("a part is a JSON text and bytes, deflated, in base85", async () => {
  const { facts, bytes } = await readPart<{ segment: number }>((await partOf(3, [30])).textContent);
  assert.equal(facts.segment, 3);
  assert.equal(bytes.length, 24 + 8);
});

test("the frames of a segment do not include the earlier one with which each segment begins", async () => {
  const segments = new Segments([await partOf(1, [9, 11, 12]), await partOf(2, [20, 20, 21])], 10, 10.5);
  assert.deepEqual(segments.numbers, [1, 2]);
  const times = async (number: number) => segments.framesOf(await segments.read(number), 0).map((frame) => frame.time);
  assert.deepEqual(await times(1), [11, 12]);
  assert.deepEqual(await times(2), [20, 21]);
  await assert.rejects(segments.read(3), /segment 3 is not in this page/);
});

test("samples are the frames with a new message, of one role if there are several", async () => {
  const abouts = [{ new: ["measured"] }, { new: ["commanded"] }, { new: [] }];
  const segments = new Segments(
    [await partOf(0, [-1, 1, 2, 3], { abouts, of: [0, 0, 1, 2] }), await partOf(1, [10, 11], { abouts, of: [2, 0] })],
    10,
    0,
  );
  const times = async (role?: string) => (await segments.samplesOf(0, role)).map((frame) => frame.time);
  assert.deepEqual(await times("measured"), [1, 11]);
  assert.deepEqual(await times("commanded"), [2]);
  assert.deepEqual(await times(), [1, 2, 11]);
});

test("a player gets the segment on show first, then the nearest, and forgets the farthest when there are too many", async () => {
  const parts = await Promise.all([0, 1, 2, 3].map((number) => partOf(number, [number], { size: 1000 })));
  const player = new PageModel({ time: 1.5, _segment: 1 }, new Map());
  const given: [number, number[]][] = [];
  player.on("msg:custom", (message) => {
    const { segment, drop } = message as { segment: number; drop: number[] };
    given.push([segment, drop]);
  });
  const feed = new Feed(player, new Segments(parts, 1, 0), 2500);
  await feed.run();
  assert.deepEqual(given, [
    [1, []],
    [2, []],
  ]);
  given.length = 0;
  player.send({ pointed: 0.5 });
  await feed.run();
  while (!given.length) await new Promise((resume) => setTimeout(resume));
  assert.deepEqual(given[0], [0, [2]]);
});

test("a model notifies of each change from any side, and not without a change", () => {
  const model = new PageModel({ time: 0, marks: [[1, 2, "a"]] }, new Map());
  const told: string[] = [];
  for (const name of ["time", "marks"]) model.on(`change:${name}`, () => told.push(name));
  model.set("time", 0);
  model.set("marks", [[1, 2, "a"]]);
  assert.deepEqual(told, []);
  model.set_state({ time: 3, marks: [] });
  assert.deepEqual(told, ["time", "marks"]);
  assert.equal(model.get("time"), 3);
});

test("samples as CSV are exact, and a name is not a formula for a spreadsheet", () => {
  const [, ...frames] = decodeFrames(trackOf("packed_scans"));
  const lines = toCsv("laser_widget", frames).trimEnd().split("\n");
  const [head, second] = lines.map((line) => line.split(","));
  assert.deepEqual(head?.slice(0, 3), ["seconds", "stamp_ns", "angle_min"]);
  const at = head?.indexOf("ranges[0]") ?? -1;
  assert.deepEqual(second?.slice(at, at + 3), ["0.5", "0.501", "0.502"]);
  assert.deepEqual(second?.slice(at + 30, at + 35), ["nan", "inf", "-inf", "0", "65"]);
  assert.equal(lines.length, 3);

  for (const [role, stamp, linear] of [
    ["commanded", "8", "0.25"],
    ["measured", "7", "0.5"],
  ] as const) {
    const speeds = toCsv("speed_widget", [speedOf(7n, 8n)], [], role)
      .trimEnd()
      .split("\n");
    assert.deepEqual(
      speeds.map((line) => line.split(",").slice(0, 3)),
      [
        ["seconds", "stamp_ns", `${role}_linear_x`],
        ["2.5", stamp, linear],
      ],
    );
  }

  const touches = toCsv("touch_widget", decodeFrames(trackOf("packed_touches")));
  assert.deepEqual(touches.split("\n").slice(0, 2), ["seconds,stamp_ns,left", "0,0,free"]);
});

/** A frame of a measured and a commanded speed, with their stamps. */
function speedOf(stamp: bigint, ofCommand: bigint): TimedFrame {
  const bytes = new DataView(new ArrayBuffer(32 + 8 * 30));
  bytes.setBigInt64(16, stamp, true);
  bytes.setFloat64(32, 3, true);
  bytes.setBigInt64(48, ofCommand, true);
  bytes.setFloat64(64, 0.5, true);
  bytes.setFloat64(112, 0.25, true);
  return { time: 2.5, about: 0, bytes };
}

function trackOf(name: string): DataView {
  const bytes = Buffer.from(readsOf(name).track, "base64");
  return new DataView(Uint8Array.from(bytes).buffer);
}

test("an address has a moment, with or without a ray", () => {
  assert.deepEqual(parseMoment("#t=24.1&ray=105"), { time: 24.1, ray: 105 });
  assert.deepEqual(parseMoment("#ray=0&widget=2"), { ray: 0, widget: 2 });
  assert.deepEqual(parseMoment("#t=1&ray=1.5"), { time: 1 }, "no such ray");
  for (const other of ["", "#wiring", "#t=", "#t=late", "#t=-1", "#t=Infinity"]) assert.equal(parseMoment(other), null);
  assert.equal(toHash({ time: 24.1, ray: 105 }), "#t=24.1&ray=105");
  assert.equal(toHash({ time: 24.10004 }), "#t=24.101", "not before the sample on show");
  assert.equal(toHash({ ray: 3, widget: 0 }), "#ray=3");
  assert.equal(toHash({}), "");
});

test("a page opens at a moment, says so, and gives a link to the next one", () => {
  const models = new Map<string, PageModel>();
  const player = new PageModel({ time: 0, _begin: 2, duration: 58, playing: true, _status: "" }, models);
  const laser = new PageModel({ pinned: null }, models);
  const named = [
    { widget: "laser_widget", model: laser },
    { widget: "player_widget", model: player },
  ];
  assert.deepEqual(momentOf(named), { time: 0 });
  showMoment(named, { time: 24.1, ray: 105 });
  assert.deepEqual([player.get("time"), player.get("playing"), laser.get("pinned")], [24.1, false, 105]);
  assert.equal(player.get("_status"), "24.10 s, from the link");
  assert.deepEqual(momentOf(named), { time: 24.1, ray: 105 });
  player.set("time", 25);
  assert.equal(player.get("_status"), "");
  showMoment(named, { time: 90 });
  assert.equal(player.get("time"), 58, "the end of the page");
  showMoment([{ widget: "laser_widget", model: laser }], { time: 3, ray: 7 });
  assert.deepEqual(momentOf([{ widget: "laser_widget", model: laser }]), { ray: 7 });
});
