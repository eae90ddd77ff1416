"""The part of `backports.zstd` that reads recordings, by fzstd in a browser."""

from __future__ import annotations

from ._whole_frames import WholeFrames, call, script

_fzstd = script("_fzstd.js")

_MAGIC, _SKIPPED = 0xFD2FB528, 0x184D2A50
_RUN, _RESERVED = 1, 3


class ZstdError(Exception):
    """Data that are not complete zstd data."""


class ZstdDecompressor(WholeFrames):
    """See `backports.zstd.ZstdDecompressor`."""

    # Source: RFC 8878, sections 3.1.1 and 3.1.2.
    def _end(self, data: bytearray) -> int | None:
        if len(data) < 8:
            return None
        magic = int.from_bytes(data[:4], "little")
        if magic & ~15 == _SKIPPED:
            at = 8 + int.from_bytes(data[4:8], "little")
            return at if at <= len(data) else None
        if magic != _MAGIC:
            raise ZstdError("not zstd data")
        flags = data[4]
        is_single = flags >> 5 & 1
        size = (is_single, 2, 4, 8)[flags >> 6]
        at, is_last = 5 + (not is_single) + (0, 1, 2, 4)[flags & 3] + size, False
        while not is_last:
            if at + 3 > len(data):
                return None
            head = int.from_bytes(data[at : at + 3], "little")
            is_last, kind, size = bool(head & 1), head >> 1 & 3, head >> 3
            if kind == _RESERVED:
                raise ZstdError("damaged zstd data")
            at += 3 + (1 if kind == _RUN else size)
        at += 4 * (flags >> 2 & 1)
        return at if at <= len(data) else None

    def _unpack(self, frame: bytes) -> bytes:
        return call(_fzstd.decompress, frame, ZstdError) if frame[:4] == _MAGIC.to_bytes(4, "little") else b""


def decompress(data: bytes) -> bytes:
    """See `backports.zstd.decompress`."""
    return call(_fzstd.decompress, data, ZstdError)
