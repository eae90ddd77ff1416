import assert from "node:assert/strict";
import { test } from "node:test";
import { inflateSync } from "node:zlib";
import { toIndexed, toPng } from "../../robowidgets/js/later/indexed_png.ts";

const [WHITE, RED, GRAY] = [0xffffff, 0xd92d20, 0xedf0f2];
const pause = async () => {};

function pixelsOf(colours: number[]): Uint8ClampedArray {
  return Uint8ClampedArray.from(colours.flatMap((c) => [c >> 16, (c >> 8) & 255, c & 255, 255]));
}

test("flat colours stay exact, and a similar colour that is rare becomes the frequent one", async () => {
  const almostWhite = 0xfdfdfd;
  const colours = [WHITE, almostWhite, WHITE, WHITE, RED, RED, GRAY];
  const { palette, indices } = await toIndexed(pixelsOf(colours), pause);
  assert.deepEqual(
    Array.from(indices, (index) => palette[index]),
    [WHITE, WHITE, WHITE, WHITE, RED, RED, GRAY],
  );
});

test("more colours than a palette has become the most similar ones", async () => {
  const colours = Array.from({ length: 1024 }, (_, i) => (((i & 31) << 3) << 16) | ((i >> 5) << 11));
  colours.push(...Array(100).fill(WHITE));
  const { palette, indices } = await toIndexed(pixelsOf(colours), pause);
  assert.equal(palette.length, 256);
  assert.equal(palette[indices.at(-1) as number], WHITE);
  const nearest = (color: number) => Math.min(...palette.map((other) => distance(other, color)));
  for (const [i, color] of colours.entries()) {
    assert.equal(distance(palette[indices[i] as number] as number, color), nearest(color));
  }
});

function distance(one: number, other: number): number {
  return [16, 8, 0].reduce((sum, shift) => sum + (((one >> shift) & 255) - ((other >> shift) & 255)) ** 2, 0);
}

test("transparent parts become white", async () => {
  const { palette, indices } = await toIndexed(new Uint8ClampedArray(8), pause);
  assert.deepEqual([palette, [...indices]], [[WHITE], [0, 0]]);
});

test("the bytes are a PNG with the size, the palette and the indices", async () => {
  const bytes = await toPng({ palette: [WHITE, RED], indices: Uint8Array.of(0, 1, 1, 1, 0, 0) }, 3);
  const view = new DataView(bytes.buffer);
  const found: Record<string, Uint8Array> = {};
  for (let at = 8; at < bytes.length; ) {
    const length = view.getUint32(at);
    found[String.fromCharCode(...bytes.subarray(at + 4, at + 8))] = bytes.subarray(at + 8, at + 8 + length);
    at += 12 + length;
  }
  assert.deepEqual(Object.keys(found), ["IHDR", "PLTE", "IDAT", "IEND"]);
  assert.deepEqual([...(found.IHDR ?? [])], [0, 0, 0, 3, 0, 0, 0, 2, 8, 3, 0, 0, 0]);
  assert.deepEqual([...(found.PLTE ?? [])], [255, 255, 255, 0xd9, 0x2d, 0x20]);
  assert.deepEqual([...inflateSync(found.IDAT as Uint8Array)], [0, 0, 1, 1, 0, 1, 0, 0]);
  // The checksum of IEND, which has no data, is the same in each PNG.
  assert.deepEqual([...bytes.subarray(-4)], [0xae, 0x42, 0x60, 0x82]);
});
