"""The part of `lz4.frame` that reads recordings, in JavaScript for a browser."""

from __future__ import annotations

from ._whole_frames import WholeFrames, call, script

_lz4 = script("_lz4.js")

_MAGIC = 0x184D2204
_PLAIN = 1 << 31
"""The bit of a block's size that marks an uncompressed block."""


class LZ4FrameDecompressor(WholeFrames):
    """See `lz4.frame.LZ4FrameDecompressor`."""

    # Source: https://github.com/lz4/lz4/blob/dev/doc/lz4_Frame_format.md
    def _end(self, data: bytearray) -> int | None:
        if len(data) < 7:
            return None
        flags = data[4]
        if int.from_bytes(data[:4], "little") != _MAGIC or flags >> 6 != 1:
            raise RuntimeError("not lz4 data")
        at, size = 7 + 8 * (flags >> 3 & 1) + 4 * (flags & 1), 1
        while size:
            if at + 4 > len(data):
                return None
            size = int.from_bytes(data[at : at + 4], "little") & ~_PLAIN
            at += 4 + size + (4 * (flags >> 4 & 1) if size else 0)
        at += 4 * (flags >> 2 & 1)
        return at if at <= len(data) else None

    def _unpack(self, frame: bytes) -> bytes:
        return call(_lz4.decompress, frame, RuntimeError)


def decompress(data: bytes) -> bytes:
    """See `lz4.frame.decompress`."""
    return call(_lz4.decompress, data, RuntimeError)


def compress(data: bytes, compression_level: int = 0) -> bytes:
    """Raise NotImplementedError: files written in a browser are not compressed."""
    raise NotImplementedError("lz4 compression is not available in a browser")
