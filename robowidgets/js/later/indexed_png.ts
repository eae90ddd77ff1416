/**
 * PNGs with a palette of 256 colours. Pictures of robots are flat colours and text: they take a third of the bytes of the
 * browser's own PNGs. `CompressionStream` compresses.
 */

const SIGNATURE = [0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a];
const MAX_COLOURS = 256;
/** Groups of colours, by the upper five bits of red, green and blue. */
const BINS = 1 << 15;
/** Pixels that are counted in one go. */
const PART = 200_000;
const WHITE = 0xffffff;

/** Colours as 0xRRGGBB, and the index of the colour of each pixel. */
export interface Indexed {
  palette: number[];
  indices: Uint8Array;
}

/**
 * Gives each pixel one of 256 colours. Similar colours, of the same upper five bits, become the one that most of them
 * have, so flat areas stay exact; rare ones the most similar colour of the palette. Transparent parts become white.
 *
 * @param pause lets the page work, between parts of it
 */
export async function toIndexed(pixels: Uint8ClampedArray, pause: () => Promise<void>): Promise<Indexed> {
  const [votes, counts, colours] = [new Int32Array(BINS), new Int32Array(BINS), new Int32Array(BINS)];
  const binned = new Uint16Array(pixels.length / 4);
  for (let start = 0; start < binned.length; start += PART) {
    countPart(pixels, binned, start, votes, counts, colours);
    await pause();
  }
  const used = [...counts.keys()].filter((bin) => counts[bin]);
  used.sort((a, b) => (counts[b] as number) - (counts[a] as number));
  const palette = used.slice(0, MAX_COLOURS).map((bin) => colours[bin] as number);
  const indexOf = new Uint8Array(BINS);
  for (const [i, bin] of used.entries()) {
    indexOf[bin] = i < MAX_COLOURS ? i : mostSimilar(palette, colours[bin] as number);
  }
  await pause();
  const indices = new Uint8Array(binned.length);
  for (let at = 0; at < binned.length; at++) indices[at] = indexOf[binned[at] as number] as number;
  return { palette, indices };
}

/** Counts the colours of a part of the pixels, by their upper bits. */
function countPart(
  pixels: Uint8ClampedArray,
  binned: Uint16Array,
  start: number,
  votes: Int32Array,
  counts: Int32Array,
  colours: Int32Array,
): void {
  const end = Math.min(start + PART, binned.length);
  for (let at = start; at < end; at++) {
    const i = 4 * at;
    const color = pixels[i + 3]
      ? ((pixels[i] as number) << 16) | ((pixels[i + 1] as number) << 8) | (pixels[i + 2] as number)
      : WHITE;
    const bin = binOf(color);
    binned[at] = bin;
    counts[bin] = (counts[bin] as number) + 1;
    // The vote of Boyer and Moore: the colour that more than half of the bin have wins.
    if (colours[bin] === color) votes[bin] = (votes[bin] as number) + 1;
    else if (votes[bin]) votes[bin] = (votes[bin] as number) - 1;
    else {
      colours[bin] = color;
      votes[bin] = 1;
    }
  }
}

function binOf(color: number): number {
  return ((color >> 9) & 0x7c00) | ((color >> 6) & 0x3e0) | ((color >> 3) & 0x1f);
}

function mostSimilar(palette: number[], color: number): number {
  let [best, least] = [0, Number.POSITIVE_INFINITY];
  for (const [i, other] of palette.entries()) {
    const [red, green, blue] = [16, 8, 0].map((shift) => ((color >> shift) & 255) - ((other >> shift) & 255));
    const distance = (red as number) ** 2 + (green as number) ** 2 + (blue as number) ** 2;
    if (distance < least) [best, least] = [i, distance];
  }
  return best;
}

/** Packs pixels of a width into the bytes of a PNG. */
export async function toPng({ palette, indices }: Indexed, width: number): Promise<Uint8Array> {
  const height = indices.length / width;
  const rows = new Uint8Array((width + 1) * height);
  for (let y = 0; y < height; y++) rows.set(indices.subarray(y * width, (y + 1) * width), y * (width + 1) + 1);
  const header = new DataView(new ArrayBuffer(13));
  header.setUint32(0, width);
  header.setUint32(4, height);
  header.setUint16(8, 0x0803); // 8 bits, indices
  const chunks = [
    chunk("IHDR", new Uint8Array(header.buffer)),
    chunk("PLTE", Uint8Array.from(palette.flatMap((color) => [color >> 16, (color >> 8) & 255, color & 255]))),
    chunk("IDAT", await deflate(rows)),
    chunk("IEND", new Uint8Array(0)),
  ];
  const bytes = new Uint8Array(SIGNATURE.length + chunks.reduce((sum, { length }) => sum + length, 0));
  bytes.set(SIGNATURE);
  let at = SIGNATURE.length;
  for (const part of chunks) {
    bytes.set(part, at);
    at += part.length;
  }
  return bytes;
}

async function deflate(bytes: Uint8Array): Promise<Uint8Array> {
  const stream = new Blob([bytes as Uint8Array<ArrayBuffer>]).stream().pipeThrough(new CompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

function chunk(type: string, data: Uint8Array): Uint8Array {
  const bytes = new Uint8Array(data.length + 12);
  const view = new DataView(bytes.buffer);
  view.setUint32(0, data.length);
  for (let i = 0; i < 4; i++) bytes[4 + i] = type.charCodeAt(i);
  bytes.set(data, 8);
  view.setUint32(data.length + 8, crc(bytes.subarray(4, data.length + 8)));
  return bytes;
}

const CRCS = Uint32Array.from({ length: 256 }, (_, n) => {
  let c = n;
  for (let k = 0; k < 8; k++) c = c & 1 ? 0xedb88320 ^ (c >>> 1) : c >>> 1;
  return c;
});

function crc(bytes: Uint8Array): number {
  let c = 0xffffffff;
  for (const byte of bytes) c = (CRCS[(c ^ byte) & 255] as number) ^ (c >>> 8);
  return ~c >>> 0;
}
