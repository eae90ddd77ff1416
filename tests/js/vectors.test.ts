import assert from "node:assert/strict";
import { test } from "node:test";
import { type Column, decodeCloud } from "../../robowidgets/js/cloud/cloud.ts";
import { decodeMoment } from "../../robowidgets/js/events/rows.ts";
import { decodeMessage } from "../../robowidgets/js/message/frame.ts";
import { elementsOf, toFields } from "../../robowidgets/js/message/tree.ts";
import { decodePose } from "../../robowidgets/js/path/path.ts";
import { decodeFrames } from "../../robowidgets/js/player/segments.ts";
import { decodePlot } from "../../robowidgets/js/plot/frame.ts";
import { decodeDetail, decodeWhole } from "../../robowidgets/js/scanogram/data.ts";
import { decodeRing } from "../../robowidgets/js/shared/frames/ring.ts";
import { decodeScan } from "../../robowidgets/js/shared/frames/scan.ts";
import { decodeSpeeds } from "../../robowidgets/js/shared/frames/speeds.ts";
import { decodeTouch } from "../../robowidgets/js/shared/frames/touch.ts";
import { frameOf, readsOf, vectors } from "./vectors.ts";

/** The fields with the given names, in plain arrays. */
function pick(read: object, names: object): Record<string, unknown> {
  const values = Object.entries(read).filter(([name]) => name in names);
  return Object.fromEntries(values.map(([name, value]) => [name, ArrayBuffer.isView(value) ? toArray(value) : value]));
}

function toArray(view: ArrayBufferView): number[] {
  return Array.from(view as Float32Array);
}

const FRAMES: Record<string, (bytes: DataView) => Record<string, unknown>> = {
  laser: (bytes) => pick(decodeScan(bytes), readsOf("laser")),
  echoes: (bytes) => pick(decodeScan(bytes), readsOf("echoes")),
  speed: (bytes) => ({ ...decodeSpeeds(bytes) }),
  touch: (bytes) => ({ ...decodeTouch(bytes) }),
  sonar: (bytes) => ({ ...decodeRing(bytes) }),
  events: (bytes) => ({ ...decodeMoment(bytes) }),
  message(bytes) {
    const packed = decodeMessage(bytes);
    const node = { name: "ids", kind: "numbers", type: "int64" } as const;
    const [ids] = toFields([node], { ...packed, values: [packed.values[4] ?? null] });
    const { sequence, rate, arrived } = packed;
    // In the table, the text is a NaN.
    const values = packed.values.map((value) => (value === "nan" ? NaN : value));
    return { sequence, rate, arrived, values, ids: ids && elementsOf(ids, 0, 2).map(({ value }) => value) };
  },
  cloud(bytes) {
    const cloud = decodeCloud(bytes);
    const [ring, pair] = ["ring", "pair"].map((name) => toArray(cloud.fields.get(name)?.values as Column));
    return { ...pick(cloud, readsOf("cloud")), ring, pair };
  },
  map(bytes) {
    const { layers, ...rest } = decodePose(bytes);
    const plain = layers.map(({ cells, ...layer }) => ({
      ...layer,
      cells: cells && { ...cells, data: [...cells.data] },
    }));
    return { ...rest, layers: plain };
  },
  plot(bytes) {
    const frame = decodePlot(bytes);
    const lines = frame?.lines.map((rows) => pick(rows, rows));
    return { ...frame, lines };
  },
  scanogram(bytes) {
    const whole = decodeWhole(bytes);
    const { scanCount, pause, counts, block, touch } = whole;
    const sweep = pick(whole.sweep, readsOf("scanogram").sweep);
    return { scanCount, pause, counts, sweep, startsAt: toArray(block.startsAt), spans: touch?.spans };
  },
  scanogram_detail(bytes) {
    const { sweep } = decodeWhole(frameOf("scanogram"));
    const { span, block } = decodeDetail(bytes, sweep);
    return { span, ranges: toArray(block.ranges) };
  },
  segment(bytes) {
    const frames = decodeFrames(bytes);
    return {
      times: frames.map(({ time }) => time),
      abouts: frames.map(({ about }) => about),
      ranges: frames.map((frame) => toArray(decodeScan(frame.bytes).ranges)),
    };
  },
};

// Frames of exported pages are tested in export.test.ts.
for (const name of Object.keys(vectors.frames).filter((name) => !name.startsWith("packed_"))) {
  test(`a frame that Python packed is read to the byte, wherever it starts: ${name}`, () => {
    for (const offset of [0, 1, 4, 6]) assert.deepEqual(FRAMES[name]?.(frameOf(name, offset)), readsOf(name));
  });
}
