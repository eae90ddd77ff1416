// Unpacks a whole frame of lz4: https://github.com/lz4/lz4/blob/dev/doc/lz4_Frame_format.md. Sums are not checked.
exports.decompress = (frame) => {
  const flags = frame[4];
  const most = 1 << (2 * ((frame[5] >> 4) & 7) + 8);
  const view = new DataView(frame.buffer, frame.byteOffset, frame.byteLength);
  let out = new Uint8Array(4 * frame.length);
  let end = 0;
  let at = 7 + (flags & 8 ? 8 : 0) + (flags & 1 ? 4 : 0);
  for (let head = view.getUint32(at, true); head; head = view.getUint32(at, true)) {
    const stop = at + 4 + (head & 0x7fffffff);
    if (out.length < end + most) {
      const longer = new Uint8Array(2 * end + most);
      longer.set(out.subarray(0, end));
      out = longer;
    }
    if (head >>> 31) {
      out.set(frame.subarray(at + 4, stop), end);
      end += stop - at - 4;
    } else {
      end = unpackBlock(frame, at + 4, stop, out, end);
    }
    at = stop + (flags & 16 ? 4 : 0);
  }
  return out.subarray(0, end);
};

/** Unpacks the bytes of a block after the earlier output, to which it may refer. Returns the new end of the output. */
function unpackBlock(from, start, stop, out, end) {
  let at = start;
  const more = (size) => {
    let byte = 255;
    while (byte === 255 && at < stop) size += byte = from[at++];
    return size;
  };
  while (at < stop) {
    const token = from[at++];
    let size = token >> 4;
    if (size === 15) size = more(size);
    if (at + size > stop || end + size > out.length) throw new Error("damaged lz4 data");
    out.set(from.subarray(at, at + size), end);
    at += size;
    end += size;
    if (at >= stop) break; // the last sequence has no match
    const back = from[at] | (from[at + 1] << 8);
    at += 2;
    size = token & 15;
    if (size === 15) size = more(size);
    size += 4;
    if (!back || back > end || end + size > out.length) throw new Error("damaged lz4 data");
    for (let i = 0; i < size; i++, end++) out[end] = out[end - back];
  }
  return end;
}
