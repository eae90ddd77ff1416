import assert from "node:assert/strict";
import { test } from "node:test";
import { Answers } from "../../robowidgets/js/image/answers.ts";
import { fitScale, paintNumbers } from "../../robowidgets/js/image/colors.ts";
import { decodeImage, FILE, FLOAT32, type Picture, toNumbers, UINT16 } from "../../robowidgets/js/image/frame.ts";
import { lookAt, placeBeside, placeIn, toPicture, zoomed } from "../../robowidgets/js/image/place.ts";
import { regionOf, statisticsOf } from "../../robowidgets/js/image/region.ts";
import { Source } from "../../robowidgets/js/image/source.ts";
import { describePixel, describeRegion, toValue } from "../../robowidgets/js/image/text.ts";
import type { ImageAbout } from "../../robowidgets/js/image/traits.ts";
import type { Stream } from "../../robowidgets/js/shared/stream.ts";
import { FakeModel } from "./models.ts";
import { vectors } from "./vectors.ts";

function pictureOf(form: number, data: ArrayBuffer, depthScale: number): Picture {
  const size = { rows: 1, columns: 4, every: 1, isExact: true };
  return { sequence: 1, rate: 10, arrived: 0, form, depthScale, data: new Uint8Array(data), ...size };
}

test("a frame has its form and its size, amid the bytes of a larger message", () => {
  const bytes = new DataView(new ArrayBuffer(100), 5, 32 + 48 + 2);
  for (const [i, value] of [7, 10, 0, 1, 4, 2, 3, 5, 0.5, 1].entries()) bytes.setFloat64(8 * i, value, true);
  bytes.setUint16(80, 300, true);
  const { data, ...picture } = decodeImage(bytes);
  const said = { form: 4, rows: 2, columns: 3, every: 5, depthScale: 0.5, isExact: true };
  assert.deepEqual(picture, { sequence: 7, rate: 10, arrived: 1, ...said });
  assert.deepEqual([...data], [44, 1]);
});

test("numbers of a depth image are metres, and an invalid distance is NaN", () => {
  const metres = new Float32Array([0, 1.5, Infinity, NaN]);
  assert.deepEqual([...toNumbers(pictureOf(FLOAT32, metres.buffer, 1))], [NaN, 1.5, NaN, NaN]);
  const millimetres = new Uint16Array([0, 250, 65535, 1000]);
  const depths = [...toNumbers(pictureOf(UINT16, millimetres.buffer, 0.001))];
  assert.deepEqual(depths, [NaN, ...[0.25, 65.535, 1].map(Math.fround)]);
  assert.deepEqual([...toNumbers(pictureOf(UINT16, millimetres.buffer, 0))], [0, 250, 65535, 1000]);
});

test("colors are fitted without the outermost hundredth, and without values there is no scale", () => {
  const numbers = Float32Array.from({ length: 1000 }, (_, i) => 1 + i / 500);
  numbers[0] = 900;
  numbers[1] = NaN;
  assert.deepEqual(fitScale(numbers), [1, 3]);
  assert.deepEqual(fitScale([NaN]), [0, 1]);
  const pixels = new Uint32Array(4);
  assert.equal(paintNumbers(pixels, [0, 2, 9, NaN], [1, 3], ["#010203", "#040506"]), 1);
  assert.deepEqual([...pixels], [0xff030201, 0xff060504, 0xff060504, 0]);
});

test("a region includes both its corners, within the picture, and its statistics ignore missing values", () => {
  assert.deepEqual(regionOf({ row: 9.5, column: -3 }, { row: 2.2, column: 3.9 }, 8, 10), [2, 8, 0, 4]);
  const found = statisticsOf([Float64Array.of(10, NaN, 2, 9, 1)], true);
  assert.deepEqual(found, { of: 5, count: 4, channels: [[1, 5.5, 5.5, 10]], isExact: true });
  assert.deepEqual(statisticsOf([Float64Array.of(NaN)], true).channels, [null]);
});

test("a step of the wheel keeps the pixel under the pointer, and the last step out shows the whole picture", () => {
  const [size, room] = [
    { width: 640, height: 480 },
    { x: 0, y: 10, width: 320, height: 240 },
  ];
  const fitted = placeIn(size, room, null);
  const at = { x: 200, y: 100 };
  const look = zoomed(fitted, -1, at, size, room);
  const placed = placeIn(size, room, look);
  for (const part of ["row", "column"] as const)
    assert.ok(Math.abs(toPicture(placed, at)[part] - toPicture(fitted, at)[part]) < 1e-9);
  assert.equal(zoomed(placed, 1, at, size, room), null);
  assert.deepEqual(lookAt(fitted, room), { scale: 0.5, column: 320, row: 240 });
});

test("the pop-up of a region does not cover it if there is room, else as little as possible", () => {
  const [size, room] = [
    { width: 150, height: 90 },
    { x: 0, y: 0, width: 320, height: 240 },
  ];
  assert.deepEqual(placeBeside(size, room, { x: 20, y: 60, width: 100, height: 60 }), { x: 8, y: 128 });
  assert.deepEqual(placeBeside(size, room, { x: 10, y: 10, width: 300, height: 120 }), { x: 10, y: 138 });
  assert.deepEqual(placeBeside(size, room, { x: 0, y: 0, width: 320, height: 200 }).y, 142);
});

test("Python is asked once for each picture, and its last answer stands until the next one", () => {
  const asked: unknown[] = [];
  const fake = new FakeModel({ _answers: true });
  const model = Object.assign(fake, { send: (question: unknown) => asked.push(question) }).model;
  const stream = { shown: null as Picture | null };
  let told = 0;
  const controller = new AbortController();
  const answers = new Answers(model, stream as unknown as Stream<Picture>, () => told++, controller.signal);
  const pixel = { row: 3, column: 5 };
  const show = (sequence: number) => {
    stream.shown = { ...pictureOf(FLOAT32, new ArrayBuffer(16), 1), sequence };
    return () => answers.valuesAt(pixel, stream.shown as Picture);
  };
  const first = show(1);
  assert.deepEqual([first(), first()], [undefined, undefined]);
  fake.tell({ of: 1, pixel: [3, 5], values: [2, "nan"] });
  assert.deepEqual(first(), [2, NaN]);
  const second = show(2);
  assert.deepEqual(second(), [2, NaN]);
  fake.tell({ of: 1, pixel: [3, 5], values: [9] });
  assert.deepEqual(second(), [2, NaN]);
  const third = show(3);
  assert.equal(third(), undefined);
  assert.deepEqual(
    asked,
    [1, 2, 3].map((of) => ({ pixel: [3, 5], of })),
  );
  const statistics = { of: 4, count: 4, channels: [[1, 2, 2, 3]] };
  assert.equal(answers.statistics([0, 2, 0, 2], stream.shown as Picture), undefined);
  fake.tell({ of: 3, region: [0, 2, 0, 2], statistics });
  assert.deepEqual(answers.statistics([0, 2, 0, 2], stream.shown as Picture), { ...statistics, isExact: true });
  assert.equal(told, 2);
  assert.equal(answers.valuesAt(pixel, pictureOf(FLOAT32, new ArrayBuffer(16), 1)), undefined);
  controller.abort();
  assert.equal(fake.listening, 0);
});

/** Fakes the parts of a page that paint a picture; each pixel is the same. */
function fakePage(pixel: number[]): void {
  const getImageData = (_x: number, _y: number, width: number, height: number) => ({
    data: Uint8ClampedArray.from({ length: 4 * width * height }, (_, i) => pixel[i % 4] as number),
  });
  const context = { putImageData() {}, clearRect() {}, drawImage() {}, getImageData };
  const ImageData = class {
    readonly data: Uint8ClampedArray;
    constructor(width: number, height: number) {
      this.data = new Uint8ClampedArray(4 * width * height);
    }
  };
  const createImageBitmap = async () => ({ width: 4, height: 1, close() {} });
  const document = { createElement: () => ({ getContext: () => context }) };
  Object.assign(globalThis, { document, ImageData, createImageBitmap });
}

for (const [encoding, base64, about, letters, values, why, found] of vectors.images) {
  test(`without Python, too, a pixel has the value of image[row, column], or is marked as a color on show: ${encoding}`, () => {
    fakePage([]);
    const source = new Source();
    const picture = decodeImage(new DataView(Uint8Array.from(Buffer.from(base64, "base64")).buffer));
    assert.ok(source.paint(picture, null, false, () => {}));
    const pixel = { row: 0, column: 2 };
    const words = describePixel(pixel, source.valuesAt(pixel, about), picture, about, null);
    const [meters] = values;
    const shown = picture.depthScale
      ? `${meters?.toFixed(3)} m`
      : values.map((value, i) => `${letters[i] ?? ""} ${toValue(value)}`.trim()).join("  ");
    assert.deepEqual([words.distance, words.details], [shown, why]);
    if (!found) return;
    const statistics = source.statistics([0, 2, 1, 4], about);
    assert.deepEqual(statistics?.channels, found);
    const { details = "" } = describeRegion([0, 2, 1, 4], statistics, picture, about);
    const lines = [...(letters || " ")].map((letter) => letter.trim()).concat(why || []);
    assert.ok(details.split("\n").every((line, i) => line.startsWith(lines[i] ?? "-")));
  });
}

test("a picture that came as a JPEG is marked as such, in the channels of its message", async () => {
  fakePage([200, 20, 10, 255]);
  const said = async (about: ImageAbout) => {
    const source = new Source();
    const picture = { ...pictureOf(FILE, new ArrayBuffer(4), 0), isExact: false };
    await new Promise<void>((resolve) => source.paint(picture, null, false, resolve));
    const pixel = { row: 0, column: 1 };
    const { distance, details } = describePixel(pixel, source.valuesAt(pixel, about), picture, about, null);
    return [distance, details];
  };
  assert.deepEqual(await said({ channels: "rgb" }), ["r 200  g 20  b 10", "about, from a JPEG"]);
  assert.deepEqual(await said({ channels: "bgr" }), ["b 10  g 20  r 200", "about, from a JPEG"]);
  assert.deepEqual(await said({}), ["200", "about, from a JPEG"]);
  const shown = ["r 200  g 20  b 10", "as shown (8 bit), from a JPEG"];
  assert.deepEqual(await said({ channels: "yuv", recolored: true }), shown);
});
