import assert from "node:assert/strict";
import { test } from "node:test";
import { Reader, toBytes } from "../../robowidgets/js/shared/bytes.ts";

/** Bytes that begin at an offset of a larger buffer, with something else before and behind. */
function within(offset: number, fill: (view: DataView) => void, length: number): DataView {
  const buffer = new ArrayBuffer(offset + length + 5);
  new Uint8Array(buffer).fill(0xff);
  const view = new DataView(buffer, offset, length);
  fill(view);
  return view;
}

test("a binary trait is exactly its bytes, in any form of view", () => {
  const buffer = Uint8Array.of(9, 1, 2, 3, 9).buffer;
  for (const value of [new DataView(buffer, 1, 3), new Uint8Array(buffer, 1, 3), Uint8Array.of(1, 2, 3).buffer]) {
    const bytes = toBytes(value);
    assert.ok(bytes);
    assert.deepEqual(
      Array.from({ length: bytes.byteLength }, (_, i) => bytes.getUint8(i)),
      [1, 2, 3],
    );
  }
});

test("an empty trait is null", () => {
  const nothing = [
    null,
    undefined,
    "",
    "abc",
    {},
    [],
    new ArrayBuffer(0),
    new DataView(new ArrayBuffer(4), 4),
    new Uint8Array(0),
  ];
  for (const value of nothing) assert.equal(toBytes(value), null);
});

for (const offset of [0, 1, 3, 4, 7, 8]) {
  test(`numbers are read little-endian, one after the other, from bytes that start at ${offset}`, () => {
    const bytes = within(
      offset,
      (view) => {
        view.setFloat64(0, 1.5, true);
        view.setFloat64(8, Number.NaN, true);
        view.setFloat64(16, -2, true);
        view.setFloat32(24, 0.25, true);
        view.setFloat32(28, Infinity, true);
        view.setUint8(32, 7);
        view.setUint8(33, 255);
      },
      34,
    );
    const reader = new Reader(bytes);
    assert.equal(reader.left, 34);
    assert.equal(reader.float64(), 1.5);
    assert.deepEqual(reader.float64s(2), [Number.NaN, -2]);
    assert.deepEqual([...reader.float32s(2)], [0.25, Infinity]);
    assert.equal(reader.left, 2);
    assert.deepEqual([...new Uint8Array(reader.bytes(2))], [7, 255]);
    assert.equal(reader.left, 0);
  });
}

test("numbers that were read are a copy", () => {
  const bytes = within(4, (view) => view.setFloat32(0, 1, true), 4);
  const [read] = [new Reader(bytes).float32s(1)];
  bytes.setFloat32(0, 2, true);
  assert.deepEqual([...read], [1]);
});
